// SPDX-License-Identifier: GPL-3.0-or-later
// Samples the height of a vertex in proportion to attenuation times a guiding table.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "guided/guide_heights.hpp"
#include "numeric/rng.hpp"

namespace lamina {

/// Draws the height t of a vertex of the scattering equation in proportion to exp(-s (top - t)) g(t), with g linear
/// between the guide's heights.
class HeightSampling {
 public:
  using Column = GuideHeights::Column;
  static constexpr Eigen::Index kMostHeights = Column::RowsAtCompileTime;

  struct Choice {
    double t;
    std::size_t cell;
    double weight;  ///< one over the density, times exp(-s (top - t))
  };

  /// `source`: g at the guide's heights, valid up to the one above `top`, which lies in `cell`.
  static Choice draw(const GuideHeights& heights, double top, std::size_t cell, double s, const Column& source,
                     Rng& rng) {
    // Compute the masses of the cells. They may be approximate, since the weight divides by the same masses.
    const Column fall = (static_cast<float>(s) * (heights.column() - static_cast<float>(top)).min(0.0F)).exp();
    const auto last = static_cast<Eigen::Index>(cell);
    const double way = heights.fraction(top, cell);
    const double g_top = static_cast<double>(source[last]) + way * static_cast<double>(source[last + 1] - source[last]);
    constexpr Eigen::Index kPairs = kMostHeights - 1;
    Column mass;
    const auto d = static_cast<float>(s) * heights.steps().head<kPairs>();
    // Weight of the upper end in the mean of a cell (EndShares), rational approximation within .3 %.
    const auto upper = 1.0F - (1.0F + 0.1F * d) / (2.0F + d * (0.5333F + 0.1F * d));
    mass.head<kPairs>() = (fall.tail<kPairs>() - fall.head<kPairs>()) *
                          (source.head<kPairs>() + upper * (source.tail<kPairs>() - source.head<kPairs>()));
    const float to_top = static_cast<float>(s) * static_cast<float>(top - heights[cell]);
    const float own_upper = 1.0F - (1.0F + 0.1F * to_top) / (2.0F + to_top * (0.5333F + 0.1F * to_top));
    mass[last] = (1.0F - fall[last]) * (source[last] + own_upper * (static_cast<float>(g_top) - source[last]));
    // Cells above the top are empty, since `fall` is constant there.
    mass[kPairs] = 0.0F;
    constexpr double kThin = 1e-3;  // differences of exponentials near 1 keep four digits of a float above it
    if (s * top < kThin) {
      // Differences of exponentials would lose all digits; lengths replace them.
      mass.head<kPairs>() = heights.steps().head<kPairs>() * (source.head<kPairs>() + source.tail<kPairs>());
      mass[last] = static_cast<float>(top - heights[cell]) * (source[last] + static_cast<float>(g_top));
      mass.tail(kPairs - last).setZero();
    }

    // Draw a cell
    const float total = mass.sum();
    auto rest = static_cast<float>(rng.uniform()) * total;
    Eigen::Index own = last;
    while (own > 0 && (rest >= mass[own] || mass[own] <= 0.0F)) {
      rest -= mass[own];
      --own;
    }

    if (!(mass[own] > 0.0F)) {
      mass.maxCoeff(&own);
    }

    // Draw the height within the cell
    const auto k = static_cast<std::size_t>(own);
    const double low = heights[k];
    const double high = own == last ? top : heights[k + 1];
    const double g_low = static_cast<double>(source[own]);
    const double g_high = own == last ? g_top : static_cast<double>(source[own + 1]);
    const double thickness = high - low;
    if (!(thickness > 0.0) || !(total > 0.0F)) {
      return {low, k, 0.0};
    }
    const Point point = within(low, high, s, g_low, g_high, rng);
    const auto probability = static_cast<double>(mass[own] / total);
    return {point.t, k, std::exp(-s * (top - high)) * point.weight / probability};
  }

  struct Point {
    double t;
    double weight;  ///< one over the density, times exp(-s (high - t))
  };

  /// The same within one cell, g linear from `g_low` to `g_high`: by rejection from the exponential.
  static Point within(double low, double high, double s, double g_low, double g_high, Rng& rng) {
    const double thickness = high - low;
    const double depth = s * thickness;
    const double fallen = std::exp(-depth);
    const bool thin = depth < 1e-6;
    const double span = thin ? depth : 1.0 - fallen;
    const EndShares shares(depth, fallen);
    const double integral = thickness * (shares.lower * g_low + shares.upper * g_high);
    const double largest = std::max(g_low, g_high);
    while (true) {
      const double passed = span * rng.uniform();
      const double t = std::max(low, high + (thin ? -passed : std::log(1.0 - passed)) / s);
      const double g = g_high + (g_low - g_high) * (high - t) / thickness;
      if (rng.uniform() * largest <= g) {
        return {t, integral / g};
      }
    }
  }
};

}  // namespace lamina
