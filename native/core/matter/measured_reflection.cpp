// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/measured_reflection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lamina {
namespace {

using std::numbers::pi;

/// Lagrange's weights of the four knots about a place, and the first of the knots.
struct Stencil {
  int first;
  std::array<double, 4> weight;

  Stencil(double place, int knots) : first(std::clamp(static_cast<int>(place) - 1, 0, knots - 4)) {
    const double t = place - first;
    const double a = t * (t - 1.0);
    const double b = (t - 2.0) * (t - 3.0);
    weight = {-(t - 1.0) * b / 6.0, 0.5 * t * b, -0.5 * a * (t - 3.0), a * (t - 2.0) / 6.0};
  }
};

double angle_of(double cosine) { return std::acos(std::min(cosine, 1.0)); }

double sine_of(double cosine) { return std::sqrt(std::max(0.0, 1.0 - cosine * cosine)); }

/// The angle with the normal at a knot.
double tilt_of(double knot) {
  const double t = knot / (MeasuredReflection::kTilts - 1);
  return 0.5 * pi * MeasuredReflection::kSteepest * t * t;
}

}  // namespace

MeasuredReflection::MeasuredReflection(double low, double high, const std::vector<std::uint16_t>& steps) {
  if (steps.size() != static_cast<std::size_t>(kTilts) * kHalves * kTurns) {
    throw std::invalid_argument("a measured reflection has a table of another size");
  }
  constexpr double kSteps = 65535.0;
  table_.reserve(steps.size());
  for (const std::uint16_t step : steps) {
    table_.push_back(low + (high - low) * step / kSteps);
  }
  for (const int half : {4, 8, 12}) {
    alpha_ = std::min(alpha_, peak_width(half));
  }
}

/// The width of GGX facets with the same half width at half maximum, over what the table has at steep tilts.
double MeasuredReflection::peak_width(int half) const {
  constexpr double kNarrowest = 1e-3;
  constexpr double kPeak = 2.0;  // a lower maximum, relative to the floor, is no peak
  const auto at = [&](int tilt) {
    return std::exp(table_[static_cast<std::size_t>((tilt * kHalves + half) * kTurns)]);
  };
  constexpr int kSteep = 3 * kTilts / 4;
  const double floor = at(kSteep);
  const double top = at(0);
  if (!(top > kPeak * floor)) {
    return 1.0;
  }
  const double middle = 0.5 * (top + floor);
  int tilt = 1;
  while (at(tilt) > middle) {
    ++tilt;
  }
  const double share = (at(tilt - 1) - middle) / (at(tilt - 1) - at(tilt));
  const double half_width = std::tan(tilt_of(tilt - 1 + share));
  return std::clamp(half_width / std::sqrt(std::numbers::sqrt2 - 1.0), kNarrowest, 1.0);
}

double MeasuredReflection::value(double mu_o, double mu_i, double along) const {
  const double sum = mu_o + mu_i;
  const double upright = std::min(sum / (2.0 * along), 1.0);
  const double flat = sine_of(upright);
  const double turned = std::abs(mu_o - mu_i) / std::max(2.0 * flat * sine_of(along), 1e-12);
  const double c = std::min(turned, 1.0);
  const double end = std::atan2(upright, flat * c);
  const double share = std::min(angle_of(along) / end, 1.0);
  const Stencil h(std::min(std::sqrt(angle_of(upright) / (0.5 * pi * kSteepest)), 1.0) * (kTilts - 1), kTilts);
  const Stencil d((1.0 - std::sqrt(1.0 - share)) * (kHalves - 1), kHalves);
  const Stencil a(c * (kTurns - 1), kTurns);
  double logarithm = 0.0;
  for (int j = 0; j < 4; ++j) {
    const double* row = table_.data() + ((h.first + j) * kHalves + d.first) * kTurns + a.first;
    double line = 0.0;
    for (int k = 0; k < 4; ++k, row += kTurns) {
      const auto k_th = static_cast<std::size_t>(k);
      line +=
          d.weight[k_th] * (a.weight[0] * row[0] + a.weight[1] * row[1] + a.weight[2] * row[2] + a.weight[3] * row[3]);
    }
    logarithm += h.weight[static_cast<std::size_t>(j)] * line;
  }
  return std::exp(logarithm) / (sum + kOffset);
}

Eigen::ArrayXd MeasuredReflection::values(double mu_o, double mu_i, const Eigen::ArrayXd& cosines) const {
  // Both directions point away from the surface: forward light comes from the azimuth opposite to the viewer.
  const double across = sine_of(mu_o) * sine_of(mu_i);
  return cosines.unaryExpr([&](double cosine) {
    return value(mu_o, mu_i, std::sqrt(std::max(0.5 * (1.0 + mu_o * mu_i - across * cosine), 1e-12)));
  });
}

Eigen::ArrayXXd MeasuredReflection::values(double mu, const FacetPairs& pairs) const {
  Eigen::ArrayXXd found(pairs.cosines.rows(), pairs.cosines.cols());
  for (Eigen::Index k = 0; k < found.rows(); ++k) {
    found.row(k) = values(mu, pairs.mu[k], pairs.cosines.row(k).transpose()).transpose();
  }
  return found;
}

}  // namespace lamina
