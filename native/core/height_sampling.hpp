// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "guide_heights.hpp"
#include "rng.hpp"

namespace lamina {

/// Draws the height of a vertex of the scattering equation in proportion to exp(-s (top - t)) g(t), with g
/// linear between the guide's heights.
class HeightSampling {
 public:
  using Column = GuideHeights::Column;
  static constexpr Eigen::Index kMostHeights = Column::RowsAtCompileTime;

  struct Choice {
    double t;
    std::size_t cell;
    double weight;  ///< one over the density, times exp(-s (top - t))
  };

  /// `source`: g at the guide's heights, at least up to the one above `top`, which lies in `cell`.
  static Choice draw(const GuideHeights& heights, double top, std::size_t cell, double s, const Column& source,
                     Rng& rng) {
    // Cells by their mass, which need not be exact: what it is taken for is what is divided by.
    const Column fall = (static_cast<float>(s) * (heights.column() - static_cast<float>(top)).min(0.0F)).exp();
    const auto last = static_cast<Eigen::Index>(cell);
    const double way = heights.fraction(top, cell);
    const double g_top = static_cast<double>(source[last]) + way * static_cast<double>(source[last + 1] - source[last]);
    constexpr Eigen::Index kPairs = kMostHeights - 1;
    Column mass;
    const auto d = static_cast<float>(s) * heights.steps().head<kPairs>();
    // Share of the upper end in a cell's mean, within .3 %.
    const auto upper = 1.0F - (1.0F + 0.1F * d) / (2.0F + d * (0.5333F + 0.1F * d));
    mass.head<kPairs>() = (fall.tail<kPairs>() - fall.head<kPairs>()) *
                          (source.head<kPairs>() + upper * (source.tail<kPairs>() - source.head<kPairs>()));
    mass[last] = (1.0F - fall[last]) * 0.5F * (source[last] + static_cast<float>(g_top));
    float total = 0.0F;
    for (Eigen::Index j = last; j >= 0; --j) {
      total += mass[j];
    }
    auto rest = static_cast<float>(rng.uniform()) * total;
    Eigen::Index own = last;
    while (own > 0 && rest >= mass[own]) {
      rest -= mass[own];
      --own;
    }

    // Within the cell: from the exponential, then kept in proportion to g.
    const auto k = static_cast<std::size_t>(own);
    const double low = heights[k];
    const double high = own == last ? top : heights[k + 1];
    const double g_low = static_cast<double>(source[own]);
    const double g_high = own == last ? g_top : static_cast<double>(source[own + 1]);
    const double thickness = high - low;
    const double span = -std::expm1(-s * thickness);
    const EndShares shares(s * thickness, 1.0 - span);
    const double integral = thickness * (shares.lower * g_low + shares.upper * g_high);
    const double largest = std::max(g_low, g_high);
    while (true) {
      const double t = std::max(low, high + std::log1p(-span * rng.uniform()) / s);
      const double g = g_high + (g_low - g_high) * (high - t) / thickness;
      if (rng.uniform() * largest <= g) {
        const double probability = static_cast<double>(mass[own] / total);
        return {t, k, std::exp(-s * (top - high)) * integral / (probability * g)};
      }
    }
  }
};

}  // namespace lamina
