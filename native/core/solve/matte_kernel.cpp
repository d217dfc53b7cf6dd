// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/matte_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

constexpr int kHeights = 64;
// The coefficients fall off as the fourth power of the order.
constexpr int kOrders = 32;
constexpr Index kAngles = 128;  // of the table

double sine_of(double cosine) { return std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))); }

/// A Fourier coefficient of max(0, a + b cos x), b >= 0: the mean of its product with cos(m x).
double clamped_wave(double a, double b, int m) {
  if (a <= -b) {
    return 0.0;
  }
  if (a >= b) {
    return m == 0 ? a : m == 1 ? 0.5 * b : 0.0;
  }
  const double end = std::acos(-a / b);
  const auto integral = [end](int n) { return n == 0 ? end : std::sin(n * end) / n; };
  return (a * integral(m) + 0.5 * b * (integral(m - 1) + integral(m + 1))) / pi;
}

/// Coefficients of one order, [height of the normal, direction], for directions of cosine `sign` * mu.
MatrixXd waves_of(const NormalHeights& heights, const VectorXd& mu, double sign, int m) {
  MatrixXd waves(kHeights, mu.size());
  for (Index j = 0; j < mu.size(); ++j) {
    const double sine = sine_of(mu[j]);
    for (Index k = 0; k < kHeights; ++k) {
      waves(k, j) = clamped_wave(sign * mu[j] * heights.cosine[k], sine * sine_of(heights.cosine[k]), m);
    }
  }
  return waves;
}

/// The place of a direction in the table: the mean of its angle and of the angle where flakes are stretched to spheres.
/// The first resolves grazing directions of upright fibers, the second those near the normal.
double table_angle(double mu, double alpha) {
  const double sine = sine_of(mu);
  return (std::atan2(sine, mu) + std::atan2(alpha * sine, mu)) / pi * (kAngles - 1);
}

/// One order of the scattering between all directions and the first `columns` of them, before the division by the
/// extinctions.
PhaseKernel undivided(const Flakes& flakes, const NormalHeights& heights, const VectorXd& mu, Index columns, int m) {
  const MatrixXd up = waves_of(heights, mu, 1.0, m);
  const MatrixXd down = waves_of(heights, mu, -1.0, m);
  const auto pairs = [&](const MatrixXd& with_up, const MatrixXd& with_down) -> MatrixXd {
    const auto weight = heights.weight.asDiagonal();
    return up.transpose() * (weight * with_up.leftCols(columns)) +
           down.transpose() * (weight * with_down.leftCols(columns));
  };
  // Light that leaves upwards and light that arrives from above meet normals of the same height.
  const MatrixXd same = pairs(up, down);
  const MatrixXd other = pairs(down, up);
  const double through = flakes.translucency.value_or(0.0);
  // Forward light arrives from the azimuth opposite to that where it leaves.
  const double turned = (1.0 - through) * (m % 2 == 0 ? 1.0 : -1.0);
  return {turned * same + through * other, turned * other + through * same};
}

}  // namespace

NormalHeights::NormalHeights(double alpha) : cosine(kHeights), weight(kHeights) {
  // Stretched to a sphere, normals are spread evenly.
  const Quadrature rule(kHeights);
  for (Index k = 0; k < kHeights; ++k) {
    const double c = rule.mu[k];
    const double stretch = std::sqrt(c * c + alpha * alpha * (1.0 - c * c));
    cosine[k] = c / stretch;
    weight[k] = 8.0 * rule.weight[k] * stretch;
  }
}

MatteKernel::MatteKernel(const Flakes& flakes, const Directions& directions)
    : flakes_(flakes),
      heights_(flakes.alpha),
      mu_(directions.mu),
      inverse_(mu_.unaryExpr([&](double mu) { return 1.0 / flakes.extinction(mu); })),
      live_(directions.live),
      correction_(VectorXd::Zero(live_)) {
  const PhaseKernel mean = order(0);
  const VectorXd weight = directions.weight.head(live_).cwiseQuotient(inverse_.head(live_));
  const VectorXd found = 0.5 * (mean.reflect + mean.transmit).topLeftCorner(live_, live_) * weight;
  for (Index i = 0; i < live_; ++i) {
    correction_[i] = 2.0 * (flakes.area(mu_[i]) * inverse_[i] - found[i]) / weight[i];
  }
}

PhaseKernel MatteKernel::order(int m) const {
  const PhaseKernel columns = undivided(flakes_, heights_, mu_, live_, m);
  const auto all = [&](const MatrixXd& sum) {
    const Index targets = mu_.size() - live_;
    MatrixXd square = MatrixXd::Zero(mu_.size(), mu_.size());
    square.leftCols(live_) = inverse_.asDiagonal() * sum * inverse_.head(live_).asDiagonal();
    square.topRightCorner(live_, targets) = square.bottomLeftCorner(targets, live_).transpose();
    return square;
  };
  PhaseKernel kernel(all(columns.reflect), all(columns.transmit));
  if (m == 0) {
    kernel.transmit.diagonal().head(live_) += correction_;
  }
  return kernel;
}

MattePhase::MattePhase(const Flakes& flakes) : flakes_(flakes) {
  VectorXd mu(kAngles);
  for (Index k = 0; k < kAngles; ++k) {
    double low = 0.0;
    double high = 0.5 * pi;
    while (high - low > 1e-14) {
      const double middle = 0.5 * (low + high);
      (table_angle(std::cos(middle), flakes.alpha) < static_cast<double>(k) ? low : high) = middle;
    }
    mu[k] = std::cos(high);
  }
  const NormalHeights heights(flakes.alpha);
  series_.fill(MatrixXd(kOrders, kAngles * kAngles));
  for (int m = 0; m < kOrders; ++m) {
    const PhaseKernel order = undivided(flakes, heights, mu, kAngles, m);
    // Twice the coefficients above 0, as series of cosines have them
    const double twice = m == 0 ? 1.0 : 2.0;
    series_[0].row(m) = twice * order.reflect.reshaped().transpose();
    series_[1].row(m) = twice * order.transmit.reshaped().transpose();
  }
}

MattePhase::Place MattePhase::place(double mu) const {
  const double x = table_angle(mu, flakes_.alpha);
  const Index first = std::clamp<Index>(static_cast<Index>(x) - 1, 0, kAngles - 4);
  Place place{first, {}};
  for (int k = 0; k < 4; ++k) {
    double weight = 1.0;
    for (int other = 0; other < 4; ++other) {
      weight *= other == k ? 1.0 : (x - static_cast<double>(first) - other) / (k - other);
    }
    place.weight[static_cast<std::size_t>(k)] = weight;
  }
  return place;
}

ArrayXd MattePhase::operator()(double mu_o, const ArrayXd& mu_i, double turn, const ArrayXd& azimuths) const {
  const MatrixXd& table = series_[turn < 0.0 ? 0 : 1];
  const Place out = place(mu_o);
  ArrayXd values(mu_i.size());
  VectorXd series;
  for (Index k = 0; k < mu_i.size(); ++k) {
    if (k == 0 || mu_i[k] != mu_i[k - 1]) {
      const Place in = place(mu_i[k]);
      const Eigen::Vector4d weight(in.weight.data());
      series.setZero(kOrders);
      for (Index j = 0; j < 4; ++j) {
        const double share = out.weight[static_cast<std::size_t>(j)];
        series.noalias() += table.middleCols((out.first + j) * kAngles + in.first, 4) * (share * weight);
      }
      series /= flakes_.extinction(mu_o) * flakes_.extinction(mu_i[k]);
    }
    // Clenshaw's recurrence
    double next = 0.0;
    double after = 0.0;
    for (Index m = kOrders - 1; m > 0; --m) {
      const double here = series[m] + 2.0 * azimuths[k] * next - after;
      after = next;
      next = here;
    }
    values[k] = std::max(0.0, series[0] + azimuths[k] * next - after);
  }
  return values;
}

}  // namespace lamina
