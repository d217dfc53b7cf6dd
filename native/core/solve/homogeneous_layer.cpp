// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/homogeneous_layer.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "matter/single_scattering_shape.hpp"
#include "numeric/legendre.hpp"
#include "solve/normalising_share.hpp"

namespace lamina {
namespace {

/// sqrt(1 - mu^2) in odd orders, 1 in even ones.
Eigen::ArrayXd parity_factor(int order, const Eigen::VectorXd& mu) {
  if (order % 2 == 0) {
    return Eigen::ArrayXd::Ones(mu.size());
  }
  return (1.0 - mu.array().square()).max(0.0).sqrt();
}

/// A symmetric function of two cosines and the thickness, as a matrix.
template <typename Shape>
Eigen::MatrixXd symmetric(const Eigen::VectorXd& mu, double tau, Shape shape) {
  Eigen::MatrixXd values(mu.size(), mu.size());
  for (Eigen::Index j = 0; j < mu.size(); ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      values(i, j) = values(j, i) = shape(mu[i], mu[j], tau);
    }
  }
  return values;
}

/// The permutation that sorts cosines in ascending order.
Eigen::PermutationMatrix<Eigen::Dynamic> ascending_order(const Eigen::VectorXd& mu) {
  std::vector<int> order(static_cast<std::size_t>(mu.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return mu[a] < mu[b]; });
  Eigen::PermutationMatrix<Eigen::Dynamic> places(mu.size());
  for (std::size_t place = 0; place < order.size(); ++place) {
    places.indices()[order[place]] = static_cast<int>(place);
  }
  return places;
}

/// A matrix between live nodes, interpolated to live nodes and targets.
Eigen::MatrixXd interpolated(const Eigen::MatrixXd& nodes, const Directions& directions) {
  const auto to_targets = directions.interpolation.bottomRows(directions.targets);
  Eigen::MatrixXd all(directions.live + directions.targets, directions.live + directions.targets);
  all.topLeftCorner(directions.live, directions.live) = nodes;
  all.bottomLeftCorner(directions.targets, directions.live).noalias() = to_targets * nodes;
  all.rightCols(directions.targets).noalias() = all.leftCols(directions.live) * to_targets.transpose();
  return all;
}

Eigen::VectorXd optical(const Eigen::VectorXd& mu, const TruncatedMedium& medium) {
  return mu.unaryExpr([&](double cosine) { return medium.optical(cosine); });
}

/// In-scattering between live nodes, with the albedo, in symmetric scaling: of even and of odd l - m.
using Scattered = std::array<Eigen::MatrixXd, 2>;

Scattered of_moments(const TruncatedMedium& medium, int order, const Eigen::VectorXd& mu, const Eigen::VectorXd& root) {
  const Eigen::MatrixXd legendre = associated_legendre(order, static_cast<int>(medium.moments.size()), mu);
  const Eigen::VectorXd weights = phase_weights(medium, order);
  Scattered scattered;
  for (Eigen::Index parity = 0; parity < 2; ++parity) {
    Eigen::MatrixXd& share = scattered[static_cast<std::size_t>(parity)];
    share = Eigen::MatrixXd::Zero(mu.size(), mu.size());
    const Eigen::Index terms = (legendre.rows() - parity + 1) / 2;
    if (terms <= 0) {
      continue;
    }
    Eigen::MatrixXd in(terms, mu.size());
    Eigen::MatrixXd out(terms, mu.size());
    for (Eigen::Index k = 0; k < terms; ++k) {
      const Eigen::Index l = 2 * k + parity;
      in.row(k) = legendre.row(l).cwiseProduct(root.transpose());
      out.row(k) = medium.albedo * weights[l] * in.row(k);
    }
    share.noalias() = in.transpose() * out;
    if (order == 0 && parity == 0) {
      share += medium.albedo * normalising_share(share / medium.albedo, root);
    }
  }
  return scattered;
}

Scattered of_flakes(const TruncatedMedium& medium, const Eigen::PermutationMatrix<Eigen::Dynamic>& ascending,
                    const PhaseKernel& phase, const Eigen::VectorXd& scale, const Eigen::VectorXd& steep) {
  const Eigen::VectorXd root = std::sqrt(0.5) * (ascending * scale).cwiseProduct(steep);
  const auto share = [&](const Eigen::MatrixXd& sum) -> Eigen::MatrixXd {
    return 0.5 * medium.albedo * (root.asDiagonal() * (ascending * sum * ascending.transpose()) * root.asDiagonal());
  };
  return {share(phase.transmit + phase.reflect), share(phase.transmit - phase.reflect)};
}

}  // namespace

HomogeneousModes::HomogeneousModes(const TruncatedMedium& medium, int order, const Directions& directions,
                                   const PhaseKernel* phase) {
  const Eigen::Index n = directions.live;
  // Put grazing nodes first. Elements grow as 1 / mu over many powers of ten, and the reduction to tridiagonal form is
  // accurate for small eigenvalues only if large elements come first.
  const Eigen::PermutationMatrix<Eigen::Dynamic> ascending = ascending_order(directions.mu.head(n));
  const Eigen::VectorXd mu = ascending * directions.mu.head(n);
  const Eigen::VectorXd steep = optical(mu, medium).cwiseSqrt().cwiseInverse();

  // A and B: out-scattering minus in-scattering, by the parity of l - m.
  const Scattered scattered = phase != nullptr
                                  ? of_flakes(medium, ascending, *phase, directions.scale.head(n), steep)
                                  : of_moments(medium, order, mu, (ascending * directions.weight).cwiseSqrt());
  const auto transfer = [&](std::size_t parity) -> Eigen::MatrixXd {
    return steep.asDiagonal() * (Eigen::MatrixXd::Identity(n, n) - scattered[parity]) * steep.asDiagonal();
  };
  const Eigen::MatrixXd b = transfer(0);
  const Eigen::LLT<Eigen::MatrixXd> a(transfer(1));
  if (a.info() != Eigen::Success) {
    throw std::runtime_error("the phase function cannot be resolved: transfer matrix is not positive");
  }
  const Eigen::MatrixXd half = a.matrixL();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(half.transpose() * (b * half));
  if (eigen.info() != Eigen::Success) {
    throw std::runtime_error("the modes of the equation of transfer did not converge");
  }
  // A conservative medium has a rate of zero, which rounding perturbs, and a half-space divides by it. This floor
  // changes the reflectance of a half-space by 1e-9.
  constexpr double kSlowest = 1e-9;
  rate_ = eigen.eigenvalues().cwiseMax(kSlowest * kSlowest).cwiseSqrt();
  if (order == 0 && medium.conserves()) {
    rate_[0] = kSlowest;
  }
  even_ = ascending.transpose() * (half * eigen.eigenvectors());
  odd_ = ascending.transpose() * a.matrixU().solve(eigen.eigenvectors());
}

HomogeneousModes::Layer HomogeneousModes::layer(double tau) const {
  const Eigen::Index n = rate_.size();
  const double h = 0.5 * tau;
  Eigen::VectorXd tangent(n);      // k tanh(k h)
  Eigen::VectorXd cotangent(n);    // tanh(k h) / k
  Eigen::VectorXd attenuation(n);  // 1 / cosh^2(k h)
  for (Eigen::Index i = 0; i < n; ++i) {
    const double k = rate_[i];
    const double slope = std::tanh(k * h);
    tangent[i] = k * slope;
    cotangent[i] = slope / k;
    const double hyperbolic = std::cosh(k * h);
    attenuation[i] = 1.0 / hyperbolic / hyperbolic;
  }
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd g = identity + odd_ * tangent.asDiagonal() * odd_.transpose();
  const Eigen::MatrixXd h_matrix = identity + even_ * cotangent.asDiagonal() * even_.transpose();
  const Eigen::LLT<Eigen::MatrixXd> g_factor(g);
  const Eigen::LLT<Eigen::MatrixXd> h_factor(h_matrix);
  Layer layer;
  layer.reflect = g_factor.solve(identity) - h_factor.solve(identity);
  // T = (1 + G)^-1 + (1 + H)^-1 - 1, in a form without cancellation for thick layers.
  const Eigen::MatrixXd passing = odd_ * attenuation.asDiagonal() * even_.transpose();
  layer.transmit = g_factor.solve(h_factor.solve(passing.transpose()).transpose());
  return layer;
}

MultipleScattering multiple_scattering(HomogeneousModes::Layer layer, const TruncatedMedium& medium,
                                       const PhaseKernel& phase, int order, const Directions& directions) {
  const Eigen::VectorXd mu = directions.mu.head(directions.live);
  const Eigen::VectorXd attenuated = optical(mu, medium);
  layer.transmit.diagonal() -= direct_transmissions(mu, medium);
  const Eigen::VectorXd inner = parity_factor(order, mu).inverse();
  const Eigen::VectorXd outer = inner.cwiseQuotient(directions.scale.head(directions.live));
  const Eigen::MatrixXd shape = symmetric(attenuated, medium.tau, single_reflection);
  const Eigen::MatrixXd passing = symmetric(attenuated, medium.tau, single_transmission);
  const double quarter = 0.25 * medium.albedo;
  const auto remainder = [&](const Eigen::MatrixXd& all, const Eigen::MatrixXd& phases,
                             const Eigen::MatrixXd& single) -> Eigen::MatrixXd {
    const Eigen::MatrixXd rest = outer.asDiagonal() * all * outer.asDiagonal() -
                                 quarter * (inner.asDiagonal() * phases.cwiseProduct(single) * inner.asDiagonal());
    // Symmetrise: the division amplifies rounding errors in thin layers.
    const Eigen::MatrixXd smooth = rest.cwiseQuotient(shape);
    return 0.5 * (smooth + smooth.transpose());
  };
  MultipleScattering multiple{remainder(layer.reflect, phase.reflect, shape),
                              remainder(layer.transmit, phase.transmit, passing), Eigen::VectorXd()};
  if (order == 0) {
    const Eigen::VectorXd scale = directions.scale.head(directions.live);
    const Eigen::VectorXd scattered = ((layer.reflect + layer.transmit) * scale).cwiseQuotient(scale);
    const Eigen::VectorXd removed = (1.0 - direct_transmissions(mu, medium).array()).matrix();
    multiple.survival = scattered.cwiseQuotient(removed);
  }
  return multiple;
}

Eigen::VectorXd direct_transmissions(const Eigen::VectorXd& mu, double tau) {
  return mu.unaryExpr([tau](double cosine) { return direct_transmission(cosine, tau); });
}

Eigen::VectorXd direct_transmissions(const Eigen::VectorXd& mu, const TruncatedMedium& medium) {
  return direct_transmissions(optical(mu, medium), medium.tau);
}

Eigen::VectorXd energy_factors(const Directions& directions, const MultipleScattering& multiple,
                               const TruncatedMedium& medium, const Eigen::MatrixXd& once,
                               const Eigen::MatrixXd& repeated) {
  const auto sums = [&](const Eigen::MatrixXd& kernel) -> Eigen::VectorXd {
    return (kernel.transpose() * directions.scale.head(directions.live))
        .cwiseQuotient(directions.scale.tail(directions.targets));
  };
  const Eigen::VectorXd all = sums(repeated);
  const Eigen::VectorXd removed =
      (1.0 - direct_transmissions(directions.mu.tail(directions.targets), medium).array()).matrix();
  const Eigen::VectorXd wanted =
      (directions.interpolation.bottomRows(directions.targets) * multiple.survival).cwiseProduct(removed) - sums(once);
  constexpr double kLargest = 1e-2;  // larger corrections would hide a failure of the nodes
  return (all.array() > 0.0)
      .select((wanted.array() / all.array()).max(1.0 - kLargest).min(1.0 + kLargest), 1.0)
      .matrix();
}

LayerShapes::LayerShapes(const Directions& directions, const TruncatedMedium& medium)
    : flakes(medium.flakes ? std::make_shared<FlakeKernel>(*medium.flakes, directions) : nullptr) {
  const Eigen::VectorXd mu = optical(directions.mu, medium);
  reflect = symmetric(mu, medium.tau, single_reflection);
  transmit = symmetric(mu, medium.tau, single_transmission);
}

LayerKernels multiple_on(const Directions& directions, const MultipleScattering& multiple,
                         const TruncatedMedium& medium, const LayerShapes& shapes, int order) {
  if (multiple.reflect.size() == 0) {
    const Eigen::Index size = directions.mu.size();
    return {Eigen::MatrixXd::Zero(size, size), Eigen::MatrixXd::Zero(size, size)};
  }
  const Eigen::VectorXd outer = parity_factor(order, directions.mu) * directions.scale.array();
  const Eigen::MatrixXd shape = outer.asDiagonal() * shapes.reflect * outer.asDiagonal();
  LayerKernels kernels{interpolated(multiple.reflect, directions).cwiseProduct(shape),
                       interpolated(multiple.transmit, directions).cwiseProduct(shape)};
  if (order == 0 && directions.targets > 0 && multiple.survival.size() > 0) {
    const auto to_targets = [&](const LayerKernels& k) -> Eigen::MatrixXd {
      return (k.reflect + k.transmit).topRightCorner(directions.live, directions.targets);
    };
    const Eigen::VectorXd factors = energy_factors(
        directions, multiple, medium, to_targets(single_on(directions, medium, shapes, 0)), to_targets(kernels));
    for (Eigen::MatrixXd* kernel : {&kernels.reflect, &kernels.transmit}) {
      auto out = kernel->bottomLeftCorner(directions.targets, directions.live);
      auto in = kernel->topRightCorner(directions.live, directions.targets);
      out = factors.asDiagonal() * out;
      in = in * factors.asDiagonal();
    }
  }
  return kernels;
}

namespace {

/// True if the single scattering of a medium in an azimuth order exceeds rounding errors.
bool scatters_once(const TruncatedMedium& medium, int order) {
  constexpr double kRounding = 1e-13;
  double largest = 0.0;
  for (std::size_t l = static_cast<std::size_t>(order); l < medium.moments.size(); ++l) {
    largest += (2.0 * static_cast<double>(l) + 1.0) * std::abs(medium.moments[l]);
  }
  return medium.albedo * largest > kRounding;
}

}  // namespace

LayerKernels single_on(const Directions& directions, const TruncatedMedium& medium, const LayerShapes& shapes,
                       int order) {
  if (!medium.flakes && !scatters_once(medium, order)) {
    const Eigen::Index size = directions.mu.size();
    return {Eigen::MatrixXd::Zero(size, size), Eigen::MatrixXd::Zero(size, size)};
  }
  const PhaseKernel phase = shapes.flakes ? shapes.flakes->order(order) : PhaseKernel(medium, order, directions.mu);
  const auto kernel = [&](const Eigen::MatrixXd& phases, const Eigen::MatrixXd& shape) -> Eigen::MatrixXd {
    return 0.25 * medium.albedo *
           (directions.scale.asDiagonal() * phases.cwiseProduct(shape) * directions.scale.asDiagonal());
  };
  return {kernel(phase.reflect, shapes.reflect), kernel(phase.transmit, shapes.transmit)};
}

ScatteringFunction layer_on(const Directions& directions, const MultipleScattering& multiple,
                            const TruncatedMedium& medium, const LayerShapes& shapes, const LayerKernels& once,
                            int order) {
  const LayerKernels rest = multiple_on(directions, multiple, medium, shapes, order);
  ScatteringFunction s = ScatteringFunction::nothing(directions.size(), directions.nodes);
  s.reflect_above.kernel = directions.spread((once.reflect + rest.reflect).eval());
  s.reflect_below.kernel = s.reflect_above.kernel;
  s.transmit.kernel = directions.spread((once.transmit + rest.transmit).eval());
  s.transmit.delta = directions.spread(direct_transmissions(directions.mu, medium));
  return s;
}

}  // namespace lamina
