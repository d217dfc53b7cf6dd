// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solve_checks.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "numeric/legendre.hpp"

namespace lamina {
namespace {

/// Legendre coefficients over one range of nodes, in both cosines.
Eigen::MatrixXd coefficients(const Eigen::MatrixXd& table, const Quadrature& range) {
  const int n = static_cast<int>(range.mu.size());
  const Eigen::VectorXd x = 2.0 * (range.mu.array() - range.low()) / (range.high() - range.low()) - 1.0;
  Eigen::MatrixXd analysis = associated_legendre(0, n, x) * range.weight.asDiagonal();
  for (int k = 0; k < n; ++k) {
    analysis.row(k) *= std::sqrt(2.0 * k + 1.0);
  }
  return analysis * table * analysis.transpose();
}

/// True for a range of directions that are grazing in a less dense medium. In this medium their cosines coincide within
/// rounding, so functions are constant there and coefficients are rounding noise.
bool falls_together(const DirectionSet::Range& range, double ior) {
  constexpr double kGrazing = 0.04;  // the tolerance holds for cosines above .05 only
  return range.ior < ior && range.nodes.high() < kGrazing;
}

/// The least entry between nodes that do not coincide.
double least_entry(const Eigen::MatrixXd& repeated, const Directions& directions, const DirectionSet& set) {
  double least = 0.0;
  Eigen::Index row = 0;
  for (const DirectionSet::Range& out : set.ranges()) {
    const Eigen::Index rows = out.nodes.mu.size();
    if (row + rows > directions.live) {
      break;
    }
    Eigen::Index column = 0;
    for (const DirectionSet::Range& in : set.ranges()) {
      const Eigen::Index columns = in.nodes.mu.size();
      if (column + columns > directions.live) {
        break;
      }
      if (!falls_together(out, directions.ior) && !falls_together(in, directions.ior)) {
        least = std::min(least, repeated.block(row, column, rows, columns).minCoeff());
      }
      column += columns;
    }
    row += rows;
  }
  return least;
}

/// The highest three Legendre coefficients of multiple scattering, relative to all scattering of the layer. If they
/// have not decayed, polynomials through the nodes do not represent the function.
double tail_share(const Eigen::MatrixXd& repeated, const Eigen::MatrixXd& all, const Directions& directions,
                  const DirectionSet& set) {
  constexpr Eigen::Index kTail = 3;
  double worst = 0.0;
  Eigen::Index first = 0;
  for (const DirectionSet::Range& range : set.ranges()) {
    const Eigen::Index n = range.nodes.mu.size();
    if (first + n > directions.live) {
      break;
    }
    if (falls_together(range, directions.ior)) {
      first += n;
      continue;
    }
    if (n <= kTail) {
      return 1.0;
    }
    const Eigen::MatrixXd of_repeated = coefficients(repeated.block(first, first, n, n), range.nodes);
    const double whole = coefficients(all.block(first, first, n, n), range.nodes).norm();
    const double tail =
        std::hypot(of_repeated.bottomRows(kTail).norm(), of_repeated.topRightCorner(n - kTail, kTail).norm());
    worst = std::max(worst, whole > 0.0 ? tail / whole : 0.0);
    first += n;
  }
  return worst;
}

}  // namespace

void SolveChecks::worsen(const SolveChecks& other) {
  // NaN is worse than any number.
  const auto worse = [](double a, double b) { return std::isnan(b) || b > a ? b : a; };
  quadrature = worse(quadrature, other.quadrature);
  phase = worse(phase, other.phase);
  energy = worse(energy, other.energy);
  reciprocity = worse(reciprocity, other.reciprocity);
  negativity = worse(negativity, other.negativity);
  azimuth = worse(azimuth, other.azimuth);
  resolution = worse(resolution, other.resolution);
}

std::string SolveChecks::problem(double tolerance) const {
  constexpr double kExact = 1e-9;   // moments are exact except for rounding
  constexpr double kEnergy = 5e-7;  // exact except for rounding, which grows at grazing nodes
  std::ostringstream text;
  const auto judge = [&](const char* name, double error, double allowed) {
    if (!(error < allowed)) {
      text << (text.tellp() > 0 ? ", " : "") << name << " error " << error << " (allowed " << allowed << ")";
    }
  };
  judge("quadrature", quadrature, kExact);
  judge("phase", phase, 0.1 * tolerance);
  judge("energy", energy, kEnergy);
  judge("reciprocity", reciprocity, kEnergy);
  judge("negativity", negativity, tolerance);
  judge("azimuth", azimuth, tolerance);
  judge("resolution", resolution, tolerance);
  return text.str();
}

SolveChecks check_layer(const HomogeneousModes::Layer& layer, const MultipleScattering& multiple,
                        const PhaseKernel& phase, const TruncatedMedium& medium, const Directions& directions,
                        const DirectionSet& set) {
  SolveChecks checks;
  const Eigen::VectorXd scale = directions.scale.head(directions.live);
  const Eigen::VectorXd arriving =
      ((layer.reflect + layer.transmit) * scale).cwiseQuotient(scale);  // R + T by incidence
  // A conservative layer must neither gain nor lose energy; other layers must not gain any.
  const double created = (arriving.array() - 1.0).maxCoeff();
  checks.energy = medium.conserves() ? std::max(created, -(arriving.array() - 1.0).minCoeff()) : created;
  checks.energy = std::max(checks.energy, 0.0);

  const Eigen::VectorXd norm = 0.5 * ((phase.reflect + phase.transmit) * directions.weight);
  checks.phase = (norm.array() - 1.0).abs().maxCoeff();

  const auto asymmetry = [](const Eigen::MatrixXd& m) {
    return (m - m.transpose()).norm() / std::max(m.norm(), 1e-300);
  };
  checks.reciprocity = std::max(asymmetry(layer.reflect), asymmetry(layer.transmit));

  // Relative to single plus multiple scattering: where single scattering dominates, the other is rounding noise.
  const double quarter = 0.25 * medium.albedo;
  const Eigen::MatrixXd turned = multiple.reflect + quarter * phase.reflect;
  const Eigen::MatrixXd passed = multiple.transmit + quarter * phase.transmit;
  const double largest = std::max(turned.maxCoeff(), passed.maxCoeff());
  double smallest =
      std::min(least_entry(multiple.reflect, directions, set), least_entry(multiple.transmit, directions, set));
  if (smallest < 0.0 && !medium.flakes) {
    // Allow for rounding: `multiple` is a difference of nearly equal numbers, divided by the scales, which are small at
    // grazing and critical angles, and by the shape of single scattering, which is small in thin layers.
    constexpr double kRounding = 1e-14;
    const LayerShapes shapes(directions, medium);
    const auto raised = [&](const Eigen::MatrixXd& values, const Eigen::MatrixXd& shape) -> Eigen::MatrixXd {
      const Eigen::MatrixXd divisors = scale.asDiagonal() * shape * scale.asDiagonal();
      return (values.array() + kRounding / divisors.array()).matrix();
    };
    smallest = std::min(least_entry(raised(multiple.reflect, shapes.reflect), directions, set),
                        least_entry(raised(multiple.transmit, shapes.transmit), directions, set));
  }
  checks.negativity = largest > 0.0 ? std::max(0.0, -smallest / largest) : 0.0;
  checks.resolution = std::max(tail_share(multiple.reflect, turned, directions, set),
                               tail_share(multiple.transmit, passed, directions, set));
  return checks;
}

}  // namespace lamina
