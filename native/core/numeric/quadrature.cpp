// SPDX-License-Identifier: GPL-3.0-or-later
#include "numeric/quadrature.hpp"

#include <cmath>
#include <numbers>

namespace lamina {

Quadrature::Quadrature(int count, double low, double high)
    : mu(count), weight(count), low_(low), high_(high), barycentric_(count) {
  const double length = high - low;
  for (int i = 0; i < count; ++i) {
    // Newton iteration on P_count from the Chebyshev guess.
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
    mu[ascending] = low + 0.5 * length * (1.0 + x);
    weight[ascending] = length / ((1.0 - x * x) * derivative * derivative);
    // Weights of the barycentric formula, (-1)^i sqrt((1 - x^2) w) (Wang and Xiang 2012): no overflow.
    barycentric_[ascending] = (ascending % 2 == 0 ? 1.0 : -1.0) * std::sqrt((1.0 - x * x) * weight[ascending]);
  }
}

double Quadrature::moment_error() const {
  double worst = 0.0;
  const double length = high_ - low_;
  const Eigen::ArrayXd x = (mu.array() - low_) / length;
  Eigen::ArrayXd power = weight.array() / length;
  for (Eigen::Index k = 0; k < 2 * mu.size(); ++k) {
    worst = std::max(worst, std::abs(power.sum() - 1.0 / static_cast<double>(k + 1)));
    power *= x;
  }
  return worst;
}

Eigen::RowVectorXd Quadrature::interpolate(double point) const {
  Eigen::VectorXd values(mu.size());
  interpolate(point, values);
  return values.transpose();
}

void Quadrature::interpolate(double point, Eigen::Ref<Eigen::VectorXd> values) const {
  values = (barycentric_.array() / (point - mu.array())).matrix();
  const double sum = values.sum();
  if (std::isfinite(sum)) {
    values /= sum;
    return;
  }
  Eigen::Index nearest = 0;
  (point - mu.array()).abs().minCoeff(&nearest);
  values.setZero();
  values[nearest] = 1.0;
}

}  // namespace lamina
