// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/adjoint_source.hpp"

#include <Eigen/LU>
#include <array>

#include "guided/guide_heights.hpp"
#include "guided/reflection_by_height.hpp"
#include "operators/adding.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {
namespace {

/// Azimuth orders are summed until one adds less than this, relative to the table's maximum.
constexpr double kUnseen = 2e-3;
/// Floor of the values at one depth, relative to their maximum: truncated orders leave some values zero or negative.
constexpr float kFloor = 1e-3F;

}  // namespace

/// Quantities common to all azimuth orders while the table is filled. The medium is upside down, so that its heights
/// are depths.
struct AdjointSource::Tabulation {
  const ReflectionByHeight& reflection;
  double ground;
  std::vector<double> depth;
  std::vector<TruncatedMedium> local;  // at each depth, or one for all
  std::vector<TruncatedMedium> piece;  // between the depths of a graded medium
  std::vector<LayerShapes> above;      // of the layers above and below each depth, or of the pieces alone
  std::vector<LayerShapes> below;
  Eigen::VectorXd mu;  // the nodes, then the table's cosines
  std::array<double, kAzimuths> angle;
  double mu_out;
  Eigen::VectorXd weight;  // of each node

  /// The nodes' shares of the scattered light of a beam of flux 4 pi: half the weight of each, times the albedo.
  Eigen::VectorXd share(double albedo) const { return (2.0 * mu_out * albedo) * weight; }

  Tabulation(const ReflectionByHeight& coarse, const GradedMedium& medium, const std::vector<double>& depths,
             double viewer);

  /// Scattering functions of the medium above each depth, and reflections of the medium and the ground below it.
  struct Parts {
    std::vector<ScatteringFunction> over;
    std::vector<DirectionOperator> under;
  };
  Parts parts(int m) const;
  std::size_t place(std::size_t j) const { return local.size() == 1 ? 0 : j; }
};

AdjointSource::Tabulation::Tabulation(const ReflectionByHeight& coarse, const GradedMedium& medium,
                                      const std::vector<double>& depths, double viewer)
    : reflection(coarse), ground(medium.ground()), depth(depths), mu_out(viewer) {
  const Directions& directions = reflection.directions();
  const Eigen::Index n = directions.nodes;
  const double tau = depth.back();
  if (medium.is_homogeneous()) {
    local.push_back(reflection.medium(0.0, tau));
    for (const double d : depth) {
      above.emplace_back(directions, reflection.medium(0.0, d));
      below.emplace_back(directions, reflection.medium(0.0, tau - d));
    }
  } else {
    for (std::size_t j = 0; j < depth.size(); ++j) {
      local.push_back(reflection.medium(depth[j], 1.0));
      if (j > 0) {
        piece.push_back(reflection.medium(0.5 * (depth[j - 1] + depth[j]), depth[j] - depth[j - 1]));
        above.emplace_back(directions, piece.back());
      }
    }
  }

  // Compute the table's cosines and azimuths
  mu.resize(n + static_cast<Eigen::Index>(kAzimuths));
  mu.head(n) = directions.mu.head(n);
  for (std::size_t k = 0; k < kAzimuths; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(kCells);
    mu[n + static_cast<Eigen::Index>(k)] = std::max(1e-6, 1.0 - x * x);
    angle[k] = 2.0 * std::asin(x);
  }

  weight = directions.weight.cwiseQuotient(directions.scale.head(n));
}

AdjointSource::Tabulation::Parts AdjointSource::Tabulation::parts(int m) const {
  const Directions& directions = reflection.directions();
  const DirectionOperator base = ScatteringFunction::lambert(ground, m, directions).reflect_above;
  const std::size_t count = depth.size();
  Parts parts{{ScatteringFunction::empty(directions)}, std::vector<DirectionOperator>(count)};
  parts.under.back() = base;
  if (piece.empty()) {
    const HomogeneousModes modes(local[0], m, directions);
    const PhaseKernel phase(local[0], m, directions.mu.head(directions.live));
    const auto layer = [&](double thickness, const LayerShapes& shapes) {
      const auto same = [&]() -> const HomogeneousModes& { return modes; };
      return reflection.layer(m, reflection.medium(0.0, thickness), phase, shapes, same);
    };
    for (std::size_t j = 0; j + 1 < count; ++j) {
      const ScatteringFunction under = layer(depth.back() - depth[j], below[j]);
      parts.under[j] = ground > 0.0 ? join_opaque(under, base) : under.reflect_above;
      parts.over.push_back(layer(depth[j + 1], above[j + 1]));
    }
    return parts;
  }
  std::vector<ScatteringFunction> pieces;
  for (std::size_t j = 0; j + 1 < count; ++j) {
    const PhaseKernel phase(piece[j], m, directions.mu.head(directions.live));
    const auto modes = [&] { return HomogeneousModes(piece[j], m, directions); };
    pieces.push_back(reflection.layer(m, piece[j], phase, above[j], modes));
    parts.over.push_back(join(parts.over.back(), pieces.back()));
  }
  for (std::size_t j = count - 1; j-- > 0;) {
    parts.under[j] = join_opaque(pieces[j], parts.under[j + 1]);
  }
  return parts;
}

AdjointSource::AdjointSource(const GradedMedium& medium, const Ray& out) {
  // Set up the lookup of depths and azimuths
  const double sine = std::hypot(out.x, out.y);
  across_x_ = static_cast<float>(sine > 0.0 ? out.x / sine : 1.0);
  across_y_ = static_cast<float>(sine > 0.0 ? out.y / sine : 0.0);
  const double tau = medium.tau();
  const GradedMedium turned = medium.turned();
  if (medium.is_homogeneous()) {
    // Space the depths evenly in log(1 + depth / kUnit)
    const double step = std::log1p(tau / kUnit) / static_cast<double>(kDepths - 1);
    constexpr double kMost = 1e30;  // the thinnest media need more than single precision holds
    cells_per_log_ = static_cast<float>(std::min(1.0 / step, kMost));
    for (std::size_t j = 0; j + 1 < kDepths; ++j) {
      depths_.push_back(kUnit * std::expm1(step * static_cast<double>(j)));
    }
    depths_.push_back(tau);
  } else {
    const GuideHeights heights(turned);
    for (std::size_t j = 0; j < heights.size(); ++j) {
      depths_.push_back(heights[j]);
    }
  }
  last_depth_ = static_cast<float>(depths_.size() - 1) - 1e-4F;
  table_.assign(depths_.size() * kCosines * kAzimuths, 0.0F);
  if (medium.largest_albedo() == 0.0) {
    return;
  }

  // Sum azimuth orders until the contribution of one is negligible for a guide
  const Eigen::VectorXd viewer = Eigen::VectorXd::Constant(1, out.z);
  const ReflectionByHeight reflection(turned, {tau}, guide_nodes(medium), viewer);
  const Tabulation tabulation(reflection, medium, depths_, out.z);
  for (int m = 0; m < reflection.orders(); ++m) {
    const double largest = add_order(tabulation, m);
    const float most = *std::max_element(table_.begin(), table_.end());
    if (largest < kUnseen * static_cast<double>(most)) {
      break;
    }
  }

  // Raise values that are zero or negative
  constexpr std::ptrdiff_t kSection = kCosines * kAzimuths;
  const float whole = std::max(0.0F, *std::max_element(table_.begin(), table_.end()));
  for (auto section = table_.begin(); section != table_.end(); section += kSection) {
    // Between two depths a graded medium may scatter although it does not scatter at either depth.
    const float most = medium.is_homogeneous() ? std::max(0.0F, *std::max_element(section, section + kSection)) : whole;
    std::transform(section, section + kSection, section, [&](float value) { return std::max(value, kFloor * most); });
  }
}

/// Adds azimuth order m to the table. Returns the largest absolute value that it adds, at azimuth 0.
double AdjointSource::add_order(const Tabulation& tabulation, int m) {
  const Directions& directions = tabulation.reflection.directions();
  const Eigen::Index n = directions.nodes;
  const auto points = static_cast<Eigen::Index>(kAzimuths);
  const Tabulation::Parts parts = tabulation.parts(m);
  std::vector<PhaseKernel> towards;
  for (const TruncatedMedium& local : tabulation.local) {
    towards.emplace_back(local, m, tabulation.mu);
  }
  std::array<float, kAzimuths> wave;
  for (std::size_t a = 0; a < kAzimuths; ++a) {
    wave[a] = static_cast<float>((m == 0 ? 1.0 : 2.0) * std::cos(m * tabulation.angle[a]));
  }
  double largest = 0.0;
  for (std::size_t j = 0; j < depths_.size(); ++j) {
    // Solve for the beam's diffuse light at this depth: D = T + R' R D, U = R D, without the beam itself
    const ScatteringFunction& over = parts.over[j];
    const DirectionOperator& mirror = parts.under[j];
    const Eigen::MatrixXd kernel = mirror.kernel.topLeftCorner(n, n);
    const Eigen::MatrixXd back = over.reflect_below.kernel.topLeftCorner(n, n);
    const Eigen::VectorXd once = mirror.kernel.col(n).head(n) * over.transmit.delta[n];
    const Eigen::VectorXd first = over.transmit.kernel.col(n).head(n) + back * once;
    const Eigen::VectorXd down = (Eigen::MatrixXd::Identity(n, n) - back * kernel).partialPivLu().solve(first).eval();
    const Eigen::VectorXd up = once + kernel * down;
    if (m == 0 && j + 1 == depths_.size()) {
      // A Lambert surface scatters a flux as strongly as its own light reaches the viewer.
      ground_ = 4.0 * tabulation.share(tabulation.ground).cwiseProduct(directions.mu.head(n)).dot(down);
    }

    // Scatter it once into the directions of the table, reversed, because the light of the walk travels the opposite
    // way
    const std::size_t here = tabulation.place(j);
    const Eigen::VectorXd share = tabulation.share(tabulation.local[here].albedo);
    const Eigen::MatrixXd turned = towards[here].reflect.bottomLeftCorner(points, n) * share.asDiagonal();
    const Eigen::MatrixXd passed = towards[here].transmit.bottomLeftCorner(points, n) * share.asDiagonal();
    const Eigen::VectorXd of_down = turned * down + passed * up;
    const Eigen::VectorXd of_up = passed * down + turned * up;
    largest = std::max({largest, of_down.cwiseAbs().maxCoeff(), of_up.cwiseAbs().maxCoeff()});
    float* section = &table_[j * kCosines * kAzimuths];
    for (std::size_t i = 0; i < kCosines; ++i) {
      const bool falls = i <= kCells;
      const auto point = static_cast<Eigen::Index>(falls ? i : 2 * kCells - i);
      const auto value = static_cast<float>(falls ? of_down[point] : of_up[point]);
      for (std::size_t a = 0; a < kAzimuths; ++a) {
        section[i * kAzimuths + a] += wave[a] * value;
      }
    }
  }
  return largest;
}

}  // namespace lamina
