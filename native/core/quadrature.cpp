// SPDX-License-Identifier: GPL-3.0-or-later
#include "quadrature.hpp"

#include <cmath>
#include <numbers>

namespace lamina {
namespace {

/// Weights of the barycentric formula; for Gauss-Legendre nodes x on (-1, 1) with weights w they are
/// (-1)^i sqrt((1 - x^2) w) (Wang and Xiang 2012), which cannot overflow.
Eigen::VectorXd barycentric_weights(const Quadrature& quadrature) {
  Eigen::VectorXd weights(quadrature.mu.size());
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const double x = 2.0 * quadrature.mu[i] - 1.0;
    weights[i] = (i % 2 == 0 ? 1.0 : -1.0) * std::sqrt((1.0 - x * x) * quadrature.weight[i]);
  }
  return weights;
}

}  // namespace

Quadrature::Quadrature(int count) : mu(count), weight(count) {
  for (int i = 0; i < count; ++i) {
    // Newton's iteration on P_count from Chebyshev's guess.
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
    double derivative = 0.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double before = 1.0;
      double value = x;
      for (int l = 2; l <= count; ++l) {
        const double next = ((2.0 * l - 1.0) * x * value - (l - 1.0) * before) / l;
        before = value;
        value = next;
      }
      derivative = count * (before - x * value) / (1.0 - x * x);
      const double step = value / derivative;
      x -= step;
      if (std::abs(step) < 1e-16) {
        break;
      }
    }
    const int ascending = count - 1 - i;
    mu[ascending] = 0.5 * (1.0 + x);
    weight[ascending] = 1.0 / ((1.0 - x * x) * derivative * derivative);
  }
}

double Quadrature::moment_error() const {
  double worst = 0.0;
  Eigen::ArrayXd power = weight.array();
  for (Eigen::Index k = 0; k < 2 * mu.size(); ++k) {
    worst = std::max(worst, std::abs(power.sum() - 1.0 / static_cast<double>(k + 1)));
    power *= mu.array();
  }
  return worst;
}

Directions::Directions(const Quadrature& quadrature, const Eigen::VectorXd& targets)
    : mu(quadrature.mu.size() + targets.size()),
      scale(Eigen::VectorXd::Ones(mu.size())),
      nodes(quadrature.mu.size()),
      interpolation(Eigen::MatrixXd::Zero(mu.size(), nodes)) {
  mu << quadrature.mu, targets;
  scale.head(nodes) = (2.0 * quadrature.mu.array() * quadrature.weight.array()).sqrt();
  interpolation.topRows(nodes).setIdentity();
  const Eigen::VectorXd weights = barycentric_weights(quadrature);
  for (Eigen::Index row = nodes; row < size(); ++row) {
    const Eigen::ArrayXd distance = mu[row] - quadrature.mu.array();
    Eigen::Index nearest = 0;
    if (distance.abs().minCoeff(&nearest) < 1e-15) {
      interpolation(row, nearest) = 1.0;
      continue;
    }
    const Eigen::ArrayXd terms = weights.array() / distance;
    interpolation.row(row) = (terms / terms.sum()).matrix().transpose();
  }
}

}  // namespace lamina
