// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve_checks.hpp"

#include <algorithm>
#include <cmath>

#include "legendre.hpp"

namespace lamina {
namespace {

/// Share of the highest three Legendre coefficients, in either cosine, of a table over the nodes: where
/// the coefficients have not decayed, polynomials through the nodes do not represent the function.
double tail_share(const Eigen::MatrixXd& table, const Quadrature& quadrature) {
  constexpr Eigen::Index kTail = 3;
  const int n = static_cast<int>(quadrature.mu.size());
  const Eigen::VectorXd x = 2.0 * quadrature.mu.array() - 1.0;
  Eigen::MatrixXd analysis = associated_legendre(0, n, x) * quadrature.weight.asDiagonal();
  for (int k = 0; k < n; ++k) {
    analysis.row(k) *= std::sqrt(2.0 * k + 1.0);
  }
  const Eigen::MatrixXd coefficients = analysis * table * analysis.transpose();
  const double whole = coefficients.norm();
  const double tail =
      std::hypot(coefficients.bottomRows(kTail).norm(), coefficients.topRightCorner(n - kTail, kTail).norm());
  return whole > 0.0 ? tail / whole : 0.0;
}

}  // namespace

void SolveChecks::worsen(const SolveChecks& other) {
  // A NaN must not slip through a comparison.
  const auto worse = [](double a, double b) { return std::isnan(b) || b > a ? b : a; };
  quadrature = worse(quadrature, other.quadrature);
  phase = worse(phase, other.phase);
  energy = worse(energy, other.energy);
  reciprocity = worse(reciprocity, other.reciprocity);
  negativity = worse(negativity, other.negativity);
  resolution = worse(resolution, other.resolution);
}

SolveChecks check_layer(const HomogeneousModes::Layer& layer, const MultipleScattering& multiple,
                        const PhaseKernel& phase, const TruncatedMedium& medium, const Quadrature& quadrature) {
  SolveChecks checks;
  const Eigen::VectorXd scale = (2.0 * quadrature.mu.array() * quadrature.weight.array()).sqrt();
  const Eigen::VectorXd arriving =
      ((layer.reflect + layer.transmit) * scale).cwiseQuotient(scale);  // R + T by incidence
  // Albedo 1 loses nothing; else no more may come out than went in.
  const double created = (arriving.array() - 1.0).maxCoeff();
  checks.energy = medium.albedo == 1.0 ? std::max(created, -(arriving.array() - 1.0).minCoeff()) : created;
  checks.energy = std::max(checks.energy, 0.0);

  const Eigen::VectorXd norm = 0.5 * ((phase.reflect + phase.transmit) * quadrature.weight);
  checks.phase = (norm.array() - 1.0).abs().maxCoeff();

  const auto asymmetry = [](const Eigen::MatrixXd& m) {
    return (m - m.transpose()).norm() / std::max(m.norm(), 1e-300);
  };
  checks.reciprocity = std::max(asymmetry(layer.reflect), asymmetry(layer.transmit));

  const double largest = std::max(multiple.reflect.maxCoeff(), multiple.transmit.maxCoeff());
  const double smallest = std::min(multiple.reflect.minCoeff(), multiple.transmit.minCoeff());
  checks.negativity = largest > 0.0 ? std::max(0.0, -smallest / largest) : 0.0;
  checks.resolution = std::max(tail_share(multiple.reflect, quadrature), tail_share(multiple.transmit, quadrature));
  return checks;
}

}  // namespace lamina
