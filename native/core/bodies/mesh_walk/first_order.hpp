// SPDX-License-Identifier: GPL-3.0-or-later
// The radiance that leaves a point, to the first order in the direction.
#pragma once
#include <array>
#include <cstddef>

#include "events/sphere.hpp"
#include "interior/channels.hpp"

namespace lamina {

/// The radiance of each channel, as the cosine-weighted mean over the directions w about the normal n; then the slope.
/// The slope is the vector b of the linear function a + b.w that fits the mean over channels best (cosine-weighted
/// least squares). Behind a smooth boundary, the fit is to this mean divided by the share that the boundary lets out
/// along w.
using FirstOrder = std::array<double, kChannels + 3>;

/// What a sample of radiance 1 in the direction w adds to the slope, if directions have the density cosine / pi. With
/// this density the mean of w is 2/3 n, and the variance of w is 1/18 along n and 1/4 across. `passed`: the share that
/// the boundary lets out along w.
inline Ray slope_towards(const Ray& w, const Ray& n, double passed) {
  const double across = 4.0 / passed;
  const double along = (14.0 * w.dot(n) - 12.0) / passed;
  return {across * w.x + along * n.x, across * w.y + along * n.y, across * w.z + along * n.z};
}

/// Adds light with these weights times a factor. `slope`: the result of slope_towards for the light's direction.
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
