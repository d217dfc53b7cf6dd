// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/adjoint_source.hpp"

#include <array>

#include "guided/reflection_by_height.hpp"
#include "operators/adding.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {
namespace {

/// Depths from the top at which light that leaves there begins to be spread out.
constexpr double kUnit = 0.05;

/// Nodes that see the phase function's peak well enough for a guide.
int nodes_for(const GradedMedium& medium) {
  const double peak = medium.knots().front().phase.peak();
  return peak > 0.85 ? 24 : peak > 0.4 ? 16 : 12;
}

/// One azimuth order of a layer as the nodes and the viewer see it.
ScatteringFunction layer(const ReflectionByHeight& reflection, const HomogeneousModes& modes, const PhaseKernel& phase,
                         const LayerShapes& shapes, int m, double tau) {
  const Directions& directions = reflection.directions();
  if (tau <= 0.0) {
    return ScatteringFunction::empty(directions);
  }
  const TruncatedMedium seen = reflection.medium(0.0, tau);
  // Where hardly anything is scattered twice, rounding would show instead.
  constexpr double kFaintest = 1e-7;
  const Eigen::Index n = directions.live;
  const MultipleScattering multiple =
      seen.albedo * seen.tau > kFaintest
          ? multiple_scattering(modes.layer(seen.tau), seen, phase, m, directions)
          : MultipleScattering{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd()};
  return layer_on(directions, multiple, seen, shapes, single_on(directions, seen, shapes, m), m);
}

}  // namespace

AdjointSource::AdjointSource(const GradedMedium& medium, const Ray& out) {
  const double sine = std::hypot(out.x, out.y);
  across_x_ = static_cast<float>(sine > 0.0 ? out.x / sine : 1.0);
  across_y_ = static_cast<float>(sine > 0.0 ? out.y / sine : 0.0);
  const double tau = medium.tau();
  const double step = std::log1p(tau / kUnit) / static_cast<double>(kDepths - 1);
  inverse_unit_ = static_cast<float>(1.0 / kUnit);
  cells_per_log_ = static_cast<float>(1.0 / step);
  table_.assign(kDepths * kCosines * kAzimuths, 0.0F);

  const Eigen::VectorXd viewer = Eigen::VectorXd::Constant(1, out.z);
  const ReflectionByHeight reflection(medium, {tau}, nodes_for(medium), viewer);
  const Directions& directions = reflection.directions();
  const Eigen::Index n = directions.nodes;
  const TruncatedMedium whole = reflection.medium(0.0, tau);
  std::array<double, kDepths> depth;
  std::vector<LayerShapes> above;
  std::vector<LayerShapes> below;
  for (std::size_t j = 0; j < kDepths; ++j) {
    depth[j] = j + 1 == kDepths ? tau : kUnit * std::expm1(step * static_cast<double>(j));
    above.emplace_back(directions, whole.tau * depth[j] / tau);
    below.emplace_back(directions, whole.tau * (tau - depth[j]) / tau);
  }
  Eigen::VectorXd mu(n + static_cast<Eigen::Index>(kAzimuths));
  mu.head(n) = directions.mu.head(n);
  std::array<double, kAzimuths> angle;
  for (std::size_t k = 0; k < kAzimuths; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(kCells);
    mu[n + static_cast<Eigen::Index>(k)] = std::max(1e-6, 1.0 - x * x);
    angle[k] = 2.0 * std::asin(x);
  }
  // A beam of flux 4 pi; of its light, half the weight of each node.
  const Eigen::VectorXd share =
      (2.0 * out.z * whole.albedo) * directions.weight.cwiseQuotient(directions.scale.head(n));

  for (int m = 0; m < reflection.orders(); ++m) {
    const HomogeneousModes modes(whole, m, directions);
    const PhaseKernel phase(whole, m, directions.mu.head(directions.live));
    const PhaseKernel towards(whole, m, mu);
    const auto points = static_cast<Eigen::Index>(kAzimuths);
    const Eigen::MatrixXd turned = towards.reflect.bottomLeftCorner(points, n) * share.asDiagonal();
    const Eigen::MatrixXd passed = towards.transmit.bottomLeftCorner(points, n) * share.asDiagonal();
    std::array<float, kAzimuths> wave;
    for (std::size_t a = 0; a < kAzimuths; ++a) {
      wave[a] = static_cast<float>((m == 0 ? 1.0 : 2.0) * std::cos(m * angle[a]));
    }
    double largest = 0.0;
    for (std::size_t j = 0; j < kDepths; ++j) {
      const ScatteringFunction over = layer(reflection, modes, phase, above[j], m, depth[j]);
      const ScatteringFunction under = layer(reflection, modes, phase, below[j], m, tau - depth[j]);
      const DirectionOperator& mirror = under.reflect_above;
      // Diffuse light between the two, of the beam: D = T + R' R D, U = R D, all without the beam itself.
      const Eigen::MatrixXd kernel = mirror.kernel.topLeftCorner(n, n);
      const Eigen::MatrixXd back = over.reflect_below.kernel.topLeftCorner(n, n);
      const Eigen::VectorXd once = mirror.kernel.col(n).head(n) * over.transmit.delta[n];
      const Eigen::VectorXd first = over.transmit.kernel.col(n).head(n) + back * once;
      const Eigen::VectorXd down = (Eigen::MatrixXd::Identity(n, n) - back * kernel).partialPivLu().solve(first).eval();
      const Eigen::VectorXd up = once + kernel * down;
      // Light that travels down towards the viewer's mirror image is the beam's turned round.
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
    constexpr double kUnseen = 2e-3;
    const float most = *std::max_element(table_.begin(), table_.end());
    if (largest < kUnseen * static_cast<double>(most)) {
      break;
    }
  }
  // Nowhere zero, nor below by what the orders left out.
  constexpr std::ptrdiff_t kSection = kCosines * kAzimuths;
  for (auto section = table_.begin(); section != table_.end(); section += kSection) {
    const float least = 1e-3F * std::max(0.0F, *std::max_element(section, section + kSection));
    std::transform(section, section + kSection, section, [&](float value) { return std::max(value, least); });
  }
}

}  // namespace lamina
