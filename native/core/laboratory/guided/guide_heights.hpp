// SPDX-License-Identifier: GPL-3.0-or-later
// The heights in a slab at which guiding tables hold values.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "matter/graded_medium.hpp"

namespace lamina {

/// The heights of a guide's tables: 0, then ascending by a constant factor to the slab's thickness, and the heights of
/// the medium's knots, at jumps from both sides.
class GuideHeights {
 public:
  static constexpr std::size_t kCount = 24;  ///< three registers of eight floats; walks are unbiased for any number
  using Column = Eigen::Array<float, static_cast<int>(kCount), 1>;

  explicit GuideHeights(const GradedMedium& medium) : GuideHeights(medium.tau(), own_heights(medium)) {}

  /// `own` are the heights of knots, ascending between 0 and tau, at most kMostOwn.
  explicit GuideHeights(double tau, const std::vector<double>& own = {}) : t_(kCount) {
    constexpr double kLowest = 0.02;  // layers below it scatter nearly all light once at most
    const double first = std::min(0.1 * tau, kLowest);
    const std::size_t plain = kCount - own.size();
    const double steps = static_cast<double>(plain - 2);
    for (std::size_t j = 1; j < plain; ++j) {
      t_[j] = first * std::pow(tau / first, static_cast<double>(j - 1) / steps);
    }
    t_[plain - 1] = tau;
    std::copy(own.begin(), own.end(), t_.begin() + static_cast<std::ptrdiff_t>(plain));
    std::sort(t_.begin(), t_.end());
    for (std::size_t j = 0; j < kCount; ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      column_[k] = static_cast<float>(t_[j]);
      steps_[k] = static_cast<float>(t_[std::min(j + 1, kCount - 1)] - t_[j]);
    }
  }

  /// All heights, and the lengths of the cells above each.
  const Column& column() const { return column_; }
  const Column& steps() const { return steps_; }

  std::size_t size() const { return t_.size(); }
  double operator[](std::size_t j) const { return t_[j]; }

  std::size_t last_cell() const { return t_.size() - 2; }
  double fraction(double t, std::size_t j) const { return (t - t_[j]) / (t_[j + 1] - t_[j]); }

  std::vector<double> above_zero() const { return {t_.begin() + 1, t_.end()}; }

 private:
  static constexpr std::size_t kMostOwn = 12;  // leaves half of the heights to the geometric sequence

  /// The heights of the medium's knots. If there are too many, jumps come first, and the tables interpolate across the
  /// others.
  static std::vector<double> own_heights(const GradedMedium& medium) {
    constexpr double kApart = 1e-6;  // of tau, between the two sides of a jump
    const std::vector<double> inner = medium.inner_heights();
    std::vector<double> own;
    for (std::size_t k = 1; k < inner.size() && own.size() + 2 <= kMostOwn; ++k) {
      if (inner[k] == inner[k - 1]) {
        own.push_back(inner[k]);
        own.push_back(inner[k] + kApart * medium.tau());
      }
    }
    const std::size_t jumps = own.size();
    for (std::size_t k = 0; k < inner.size() && own.size() < kMostOwn; ++k) {
      if (std::find(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(jumps), inner[k]) ==
          own.begin() + static_cast<std::ptrdiff_t>(jumps)) {
        own.push_back(inner[k]);
      }
    }
    std::sort(own.begin(), own.end());
    return own;
  }

  std::vector<double> t_;
  Column column_;
  Column steps_;
};

/// Weights of the two end values in the mean over x from 0 to 1 of a linear function times exp(-d (1 - x)); `fall` is
/// exp(-d).
struct EndShares {
  double lower;
  double upper;

  EndShares(double d, double fall) {
    // With A = (1 - exp(-d)) / d, upper = (1 - A) / d and lower = A - upper.
    if (d < 0.02) {  // series, with an error below 1e-9
      upper = 0.5 - d * (1.0 / 6.0 - d * (1.0 / 24.0 - d / 120.0));
      lower = 0.5 - d * (1.0 / 3.0 - d * (0.125 - d / 30.0));
    } else {
      const double mean = (1.0 - fall) / d;
      upper = (1.0 - mean) / d;
      lower = mean - upper;
    }
  }
};

}  // namespace lamina
