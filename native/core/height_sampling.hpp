// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>

#include "guide_heights.hpp"
#include "rng.hpp"

namespace lamina {

/// Draws the height of a vertex of the scattering equation in proportion to exp(-s (top - t)) g(t), with g
/// linear between the guide's heights: cells are looked through from the top, where most light turns.
class HeightSampling {
 public:
  static constexpr std::size_t kMostHeights = 64;

  struct Choice {
    double t;
    std::size_t cell;
    double integral;  ///< of exp(-s (top - t)) g(t) over all heights
    double source;    ///< g(t); integral / source is what a sample weighs
  };

  /// `source(j)`: g at the guide's height j. `top` lies in `cell`.
  template <typename Source>
  static Choice draw(const GuideHeights& heights, double top, std::size_t cell, double s, const Source& source,
                     Rng& rng) {
    // Below this depth of exp, nothing is left to find.
    constexpr double kDeepest = 32.0;
    std::array<double, kMostHeights> mass;
    std::array<double, kMostHeights> lower_source;
    double upper_source = source(cell + 1);
    double upper_t = heights[cell + 1];
    double attenuation = 1.0;
    double total = 0.0;
    double top_source = 0.0;
    std::size_t j = cell + 1;
    std::size_t cells = 0;
    do {
      --j;
      const double lower_t = heights[j];
      const double lower = source(j);
      lower_source[cells] = lower;
      if (cells == 0) {
        upper_source = lower + (upper_source - lower) * (top - lower_t) / (upper_t - lower_t);
        upper_t = top;
        top_source = upper_source;
      }
      const double d = s * (upper_t - lower_t);
      const double fall = std::exp(-d);
      const EndShares shares(d, fall);
      mass[cells] = attenuation * (upper_t - lower_t) * (shares.lower * lower + shares.upper * upper_source);
      total += mass[cells];
      attenuation *= fall;
      upper_source = lower;
      upper_t = lower_t;
      ++cells;
    } while (j > 0 && s * (top - upper_t) < kDeepest);

    double rest = rng.uniform() * total;
    std::size_t chosen = 0;
    while (chosen + 1 < cells && rest >= mass[chosen]) {
      rest -= mass[chosen];
      ++chosen;
    }
    // Within the cell: from the exponential, then kept in proportion to g.
    const std::size_t own = cell - chosen;
    const double low = heights[own];
    const double high = chosen == 0 ? top : heights[own + 1];
    const double g_low = lower_source[chosen];
    const double g_high = chosen == 0 ? top_source : lower_source[chosen - 1];
    const double largest = std::max(g_low, g_high);
    const double span = -std::expm1(-s * (high - low));
    while (true) {
      const double t = std::max(low, high + std::log1p(-span * rng.uniform()) / s);
      const double g = g_high + (g_low - g_high) * (high - t) / (high - low);
      if (rng.uniform() * largest <= g) {
        return {t, own, total, g};
      }
    }
  }
};

}  // namespace lamina
