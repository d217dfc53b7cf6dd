// SPDX-License-Identifier: GPL-3.0-or-later
#include "homogeneous_layer.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "legendre.hpp"
#include "single_scattering.hpp"

namespace lamina {
namespace {

Eigen::VectorXd phase_weights(const TruncatedMedium& medium, int order) {
  const int count = static_cast<int>(medium.moments.size());
  Eigen::VectorXd weights(std::max(0, count - order));
  for (int l = order; l < count; ++l) {
    weights[l - order] = (2.0 * l + 1.0) * medium.moments[static_cast<std::size_t>(l)];
  }
  return weights;
}

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

}  // namespace

HomogeneousModes::HomogeneousModes(const TruncatedMedium& medium, int order, const Quadrature& quadrature) {
  const Eigen::Index n = quadrature.mu.size();
  const int count = static_cast<int>(medium.moments.size());
  const Eigen::MatrixXd legendre = associated_legendre(order, count, quadrature.mu);
  const Eigen::VectorXd weights = phase_weights(medium, order);

  // A and B: out-scattering less in-scattering, by the parity of l - m.
  const Eigen::VectorXd root = quadrature.weight.cwiseSqrt();
  const Eigen::VectorXd steep = quadrature.mu.cwiseSqrt().cwiseInverse();
  const auto transfer = [&](Eigen::Index parity) {
    const Eigen::Index terms = (legendre.rows() - parity + 1) / 2;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n);
    if (terms > 0) {
      Eigen::MatrixXd in(terms, n);
      Eigen::MatrixXd out(terms, n);
      for (Eigen::Index k = 0; k < terms; ++k) {
        const Eigen::Index l = 2 * k + parity;
        in.row(k) = legendre.row(l).cwiseProduct(root.transpose());
        out.row(k) = medium.albedo * weights[l] * in.row(k);
      }
      matrix.noalias() -= in.transpose() * out;
    }
    return (steep.asDiagonal() * matrix * steep.asDiagonal()).eval();
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
  // A conservative medium has one rate of zero, which rounding hides and an infinite depth would divide
  // by; this floor costs a half-space 1e-9 of its reflectance.
  constexpr double kSlowest = 1e-9;
  rate_ = eigen.eigenvalues().cwiseMax(kSlowest * kSlowest).cwiseSqrt();
  if (order == 0 && medium.albedo == 1.0) {
    rate_[0] = kSlowest;
  }
  even_.noalias() = half * eigen.eigenvectors();
  odd_ = a.matrixU().solve(eigen.eigenvectors());
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
    const double hyperbolic = std::cosh(std::min(k * h, 350.0));
    attenuation[i] = 1.0 / (hyperbolic * hyperbolic);
  }
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd g = identity + odd_ * tangent.asDiagonal() * odd_.transpose();
  const Eigen::MatrixXd h_matrix = identity + even_ * cotangent.asDiagonal() * even_.transpose();
  const Eigen::LLT<Eigen::MatrixXd> g_factor(g);
  const Eigen::LLT<Eigen::MatrixXd> h_factor(h_matrix);
  Layer layer;
  layer.reflect = g_factor.solve(identity) - h_factor.solve(identity);
  // T = (1 + G)^-1 + (1 + H)^-1 - 1, brought to a form without cancellation in thick layers.
  const Eigen::MatrixXd passing = odd_ * attenuation.asDiagonal() * even_.transpose();
  layer.transmit = g_factor.solve(h_factor.solve(passing.transpose()).transpose());
  return layer;
}

PhaseKernel::PhaseKernel(const TruncatedMedium& medium, int order, const Eigen::VectorXd& mu) {
  const int count = static_cast<int>(medium.moments.size());
  const Eigen::MatrixXd legendre = associated_legendre(order, count, mu);
  const Eigen::VectorXd weights = phase_weights(medium, order);
  const auto share = [&](Eigen::Index parity) {
    const Eigen::Index terms = (legendre.rows() - parity + 1) / 2;
    Eigen::MatrixXd rows(std::max<Eigen::Index>(terms, 0), mu.size());
    Eigen::VectorXd factors(rows.rows());
    for (Eigen::Index k = 0; k < terms; ++k) {
      rows.row(k) = legendre.row(2 * k + parity);
      factors[k] = weights[2 * k + parity];
    }
    return (rows.transpose() * factors.asDiagonal() * rows).eval();
  };
  const Eigen::MatrixXd even = share(0);
  const Eigen::MatrixXd odd = share(1);
  // P_l^m(-mu) = (-1)^(l-m) P_l^m(mu).
  reflect = even - odd;
  transmit = even + odd;
}

MultipleScattering multiple_scattering(HomogeneousModes::Layer layer, const TruncatedMedium& medium,
                                       const PhaseKernel& phase, int order, const Quadrature& quadrature) {
  layer.transmit.diagonal() -= direct_transmissions(quadrature.mu, medium.tau);
  const Eigen::VectorXd scale = (2.0 * quadrature.mu.array() * quadrature.weight.array()).sqrt();
  const Eigen::VectorXd inner = parity_factor(order, quadrature.mu).inverse();
  const Eigen::VectorXd outer = inner.cwiseQuotient(scale);
  const Eigen::MatrixXd shape = symmetric(quadrature.mu, medium.tau, single_reflection);
  const Eigen::MatrixXd passing = symmetric(quadrature.mu, medium.tau, single_transmission);
  const double quarter = 0.25 * medium.albedo;
  const auto remainder = [&](const Eigen::MatrixXd& all, const Eigen::MatrixXd& phases,
                             const Eigen::MatrixXd& single) -> Eigen::MatrixXd {
    const Eigen::MatrixXd rest = outer.asDiagonal() * all * outer.asDiagonal() -
                                 quarter * (inner.asDiagonal() * phases.cwiseProduct(single) * inner.asDiagonal());
    return rest.cwiseQuotient(shape);
  };
  return {remainder(layer.reflect, phase.reflect, shape), remainder(layer.transmit, phase.transmit, passing)};
}

Eigen::VectorXd direct_transmissions(const Eigen::VectorXd& mu, double tau) {
  return mu.unaryExpr([tau](double cosine) { return direct_transmission(cosine, tau); });
}

ScatteringFunction multiple_on(const Directions& directions, const MultipleScattering& multiple,
                               const TruncatedMedium& medium, int order) {
  ScatteringFunction s = ScatteringFunction::empty(directions);
  s.transmit.delta.setZero();
  const Eigen::VectorXd outer = parity_factor(order, directions.mu) * directions.scale.array();
  const Eigen::MatrixXd& carry = directions.interpolation;
  const Eigen::MatrixXd shape =
      outer.asDiagonal() * symmetric(directions.mu, medium.tau, single_reflection) * outer.asDiagonal();
  s.reflect_above.kernel = (carry * multiple.reflect * carry.transpose()).cwiseProduct(shape);
  s.reflect_below.kernel = s.reflect_above.kernel;
  s.transmit.kernel = (carry * multiple.transmit * carry.transpose()).cwiseProduct(shape);
  return s;
}

ScatteringFunction single_on(const Directions& directions, const TruncatedMedium& medium, int order) {
  ScatteringFunction s = ScatteringFunction::empty(directions);
  s.transmit.delta.setZero();
  const PhaseKernel phase(medium, order, directions.mu);
  const auto kernel = [&](const Eigen::MatrixXd& phases, const Eigen::MatrixXd& shape) -> Eigen::MatrixXd {
    return 0.25 * medium.albedo *
           (directions.scale.asDiagonal() * phases.cwiseProduct(shape) * directions.scale.asDiagonal());
  };
  s.reflect_above.kernel = kernel(phase.reflect, symmetric(directions.mu, medium.tau, single_reflection));
  s.reflect_below.kernel = s.reflect_above.kernel;
  s.transmit.kernel = kernel(phase.transmit, symmetric(directions.mu, medium.tau, single_transmission));
  return s;
}

ScatteringFunction layer_on(const Directions& directions, const MultipleScattering& multiple,
                            const TruncatedMedium& medium, int order) {
  ScatteringFunction s = single_on(directions, medium, order);
  const ScatteringFunction rest = multiple_on(directions, multiple, medium, order);
  s.reflect_above.kernel += rest.reflect_above.kernel;
  s.reflect_below.kernel += rest.reflect_below.kernel;
  s.transmit.kernel += rest.transmit.kernel;
  s.transmit.delta = direct_transmissions(directions.mu, medium.tau);
  return s;
}

}  // namespace lamina
