// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/adjoint_source.hpp"

#include <Eigen/LU>
#include <array>

#include "guided/reflection_by_height.hpp"
#include "operators/adding.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {
namespace {

/// Below this optical depth the depths of the table are about uniform, above they form a geometric sequence.
constexpr double kUnit = 0.05;
/// Azimuth orders are summed until one adds less than this, relative to the table's maximum.
constexpr double kUnseen = 2e-3;
/// Floor of the values at one depth, relative to their maximum: truncated orders leave some values zero or negative.
constexpr float kFloor = 1e-3F;

}  // namespace

/// Quantities common to all azimuth orders while the table is filled.
struct AdjointSource::Tabulation {
  const ReflectionByHeight& reflection;
  TruncatedMedium whole;
  std::array<double, kDepths> depth;
  std::vector<LayerShapes> above;  // of the layers above and below each depth
  std::vector<LayerShapes> below;
  Eigen::VectorXd mu;  // the nodes, then the table's cosines
  std::array<double, kAzimuths> angle;
  Eigen::VectorXd share;  // of each node in the scattered light

  Tabulation(const ReflectionByHeight& coarse, double tau, double step, double mu_out);

  ScatteringFunction layer(const HomogeneousModes& modes, const PhaseKernel& phase, const LayerShapes& shapes, int m,
                           double thickness) const;
};

AdjointSource::Tabulation::Tabulation(const ReflectionByHeight& coarse, double tau, double step, double mu_out)
    : reflection(coarse), whole(coarse.medium(0.0, tau)) {
  const Directions& directions = reflection.directions();
  const Eigen::Index n = directions.nodes;

  // Space the depths evenly in log(1 + depth / kUnit)
  for (std::size_t j = 0; j < kDepths; ++j) {
    depth[j] = j + 1 == kDepths ? tau : kUnit * std::expm1(step * static_cast<double>(j));
    above.emplace_back(directions, whole.tau * depth[j] / tau);
    below.emplace_back(directions, whole.tau * (tau - depth[j]) / tau);
  }

  // Compute the table's cosines and azimuths
  mu.resize(n + static_cast<Eigen::Index>(kAzimuths));
  mu.head(n) = directions.mu.head(n);
  for (std::size_t k = 0; k < kAzimuths; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(kCells);
    mu[n + static_cast<Eigen::Index>(k)] = std::max(1e-6, 1.0 - x * x);
    angle[k] = 2.0 * std::asin(x);
  }

  // A beam of flux 4 pi; of its light, half the weight of each node.
  share = (2.0 * mu_out * whole.albedo) * directions.weight.cwiseQuotient(directions.scale.head(n));
}

/// One azimuth order of a layer, between the nodes and the viewer's direction.
ScatteringFunction AdjointSource::Tabulation::layer(const HomogeneousModes& modes, const PhaseKernel& phase,
                                                    const LayerShapes& shapes, int m, double thickness) const {
  if (thickness <= 0.0) {
    return ScatteringFunction::empty(reflection.directions());
  }
  const auto same = [&]() -> const HomogeneousModes& { return modes; };
  return reflection.layer(m, reflection.medium(0.0, thickness), phase, shapes, same);
}

AdjointSource::AdjointSource(const GradedMedium& medium, const Ray& out) {
  // Set up the lookup of depths and azimuths
  const double sine = std::hypot(out.x, out.y);
  across_x_ = static_cast<float>(sine > 0.0 ? out.x / sine : 1.0);
  across_y_ = static_cast<float>(sine > 0.0 ? out.y / sine : 0.0);
  const double tau = medium.tau();
  const double step = std::log1p(tau / kUnit) / static_cast<double>(kDepths - 1);
  inverse_unit_ = static_cast<float>(1.0 / kUnit);
  cells_per_log_ = static_cast<float>(1.0 / step);
  table_.assign(kDepths * kCosines * kAzimuths, 0.0F);

  // Sum azimuth orders until the contribution of one is negligible for a guide
  const Eigen::VectorXd viewer = Eigen::VectorXd::Constant(1, out.z);
  const ReflectionByHeight reflection(medium, {tau}, guide_nodes(medium), viewer);
  const Tabulation tabulation(reflection, tau, step, out.z);
  for (int m = 0; m < reflection.orders(); ++m) {
    const double largest = add_order(tabulation, m);
    const float most = *std::max_element(table_.begin(), table_.end());
    if (largest < kUnseen * static_cast<double>(most)) {
      break;
    }
  }

  // Raise values that are zero or negative
  constexpr std::ptrdiff_t kSection = kCosines * kAzimuths;
  for (auto section = table_.begin(); section != table_.end(); section += kSection) {
    const float least = kFloor * std::max(0.0F, *std::max_element(section, section + kSection));
    std::transform(section, section + kSection, section, [&](float value) { return std::max(value, least); });
  }
}

/// Adds azimuth order m to the table. Returns the largest absolute value that it adds, at azimuth 0.
double AdjointSource::add_order(const Tabulation& tabulation, int m) {
  const Directions& directions = tabulation.reflection.directions();
  const Eigen::Index n = directions.nodes;
  const auto points = static_cast<Eigen::Index>(kAzimuths);
  const HomogeneousModes modes(tabulation.whole, m, directions);
  const PhaseKernel phase(tabulation.whole, m, directions.mu.head(directions.live));
  const PhaseKernel towards(tabulation.whole, m, tabulation.mu);
  const Eigen::MatrixXd turned = towards.reflect.bottomLeftCorner(points, n) * tabulation.share.asDiagonal();
  const Eigen::MatrixXd passed = towards.transmit.bottomLeftCorner(points, n) * tabulation.share.asDiagonal();
  std::array<float, kAzimuths> wave;
  for (std::size_t a = 0; a < kAzimuths; ++a) {
    wave[a] = static_cast<float>((m == 0 ? 1.0 : 2.0) * std::cos(m * tabulation.angle[a]));
  }
  double largest = 0.0;
  for (std::size_t j = 0; j < kDepths; ++j) {
    // Solve for the beam's diffuse light at this depth: D = T + R' R D, U = R D, without the beam itself
    const double depth = tabulation.depth[j];
    const ScatteringFunction over = tabulation.layer(modes, phase, tabulation.above[j], m, depth);
    const ScatteringFunction under =
        tabulation.layer(modes, phase, tabulation.below[j], m, tabulation.depth[kDepths - 1] - depth);
    const DirectionOperator& mirror = under.reflect_above;
    const Eigen::MatrixXd kernel = mirror.kernel.topLeftCorner(n, n);
    const Eigen::MatrixXd back = over.reflect_below.kernel.topLeftCorner(n, n);
    const Eigen::VectorXd once = mirror.kernel.col(n).head(n) * over.transmit.delta[n];
    const Eigen::VectorXd first = over.transmit.kernel.col(n).head(n) + back * once;
    const Eigen::VectorXd down = (Eigen::MatrixXd::Identity(n, n) - back * kernel).partialPivLu().solve(first).eval();
    const Eigen::VectorXd up = once + kernel * down;

    // Scatter it once into the directions of the table, reversed, because the light of the walk travels the opposite
    // way
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
