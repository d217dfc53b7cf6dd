// SPDX-License-Identifier: GPL-3.0-or-later
// The radiance that leaves a point, to the first order in the direction.
#pragma once
#include <array>
#include <cstddef>

#include "events/sphere.hpp"
#include "interior/channels.hpp"

namespace lamina {

/// The mean radiance of each channel, cosine-weighted over the directions w about the normal n, and then the slope: the
/// vector b of the function a + b.w that is nearest, in the cosine-weighted square, to the mean over channels, divided
/// by the share that a smooth boundary lets out along w.
using FirstOrder = std::array<double, kChannels + 3>;

/// The slope of light of radiance 1 that leaves in the direction w alone, per cosine-weighted solid angle / pi. With
/// that density the mean of w is 2/3 n; the variance of w is 1/18 along n and 1/4 across. `passed`: the share that the
/// boundary lets out.
inline Ray slope_towards(const Ray& w, const Ray& n, double passed) {
  const double across = 4.0 / passed;
  const double along = (14.0 * w.dot(n) - 12.0) / passed;
  return {across * w.x + along * n.x, across * w.y + along * n.y, across * w.z + along * n.z};
}

/// Adds light with these weights times a factor. `slope`: of its direction, by slope_towards.
inline void add(FirstOrder& sum, const Weights& weights, double factor, const Ray& slope) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    sum[c] += factor * weights[c];
  }
  const double mean = factor * mean_of(weights);
  sum[kChannels] += mean * slope.x;
  sum[kChannels + 1] += mean * slope.y;
  sum[kChannels + 2] += mean * slope.z;
}

}  // namespace lamina
