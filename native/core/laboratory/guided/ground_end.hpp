// SPDX-License-Identifier: GPL-3.0-or-later
// The end of a branch of a scattering walk on a Lambert surface below the slab.
#pragma once
#include <algorithm>
#include <cmath>

#include "guided/guide_heights.hpp"
#include "numeric/rng.hpp"

namespace lamina {

/// The end of a branch on the Lambert surface below a slab of thickness `top`: S(0) = 4 a b rho for the cosines a and
/// b, attenuated by the slab.
struct GroundEnd {
  double value;  ///< exp(-s top) S(0), s = 1/a + 1/b
  double odds;   ///< probability of ending here, against vertices in the slab

  /// `source`: the guide's sum of the terms at its heights.
  GroundEnd(double reflectance, double a, double b, const GuideHeights& heights, double top,
            const GuideHeights::Column& source) {
    const double s = 1.0 / a + 1.0 / b;
    value = 4.0 * a * b * reflectance * std::exp(-s * top);
    constexpr Eigen::Index kCells = GuideHeights::kCount - 1;
    const GuideHeights::Column below = heights.column().min(static_cast<float>(top));
    const GuideHeights::Column fall = (static_cast<float>(s) * (below - static_cast<float>(top))).exp();
    const auto scattered = 0.25F * (below.tail<kCells>() - below.head<kCells>()) *
                           (fall.tail<kCells>() + fall.head<kCells>()) *
                           (source.tail<kCells>() + source.head<kCells>());
    // The trapezoidal rule overestimates where the exponential is steep.
    const double most = static_cast<double>(source.maxCoeff()) / s;
    const double rest = std::min(static_cast<double>(scattered.sum()), most);
    constexpr double kMost = 0.98;  // bounds the weight of vertices; any value below 1 is unbiased
    odds = value > 0.0 ? value / (value + rest) : 0.0;
    odds = rest > 0.0 ? std::min(odds, kMost) : odds;
  }

  /// Chooses at random whether the branch ends here. Multiplies `weight` by the outcome's value over its probability.
  bool taken(Rng& rng, double& weight) const {
    if (rng.uniform() < odds) {
      weight *= value / odds;
      return true;
    }
    weight /= 1.0 - odds;
    return false;
  }
};

}  // namespace lamina
