// SPDX-License-Identifier: GPL-3.0-or-later
// The radiance that leaves a point, with its moments over directions.
#pragma once
#include <array>
#include <cstddef>

#include "events/sphere.hpp"
#include "interior/channels.hpp"

namespace lamina {

/// Cosine-weighted means over the directions w to the eye: of the radiance of each channel, then of the mean over
/// channels times x, y, z, x^2, y^2, xy, yz and zx of w.
using LightMoments = std::array<double, kChannels + 8>;

/// Adds light along w with these weights times a factor.
inline void add(LightMoments& sum, const Weights& weights, double factor, const Ray& w) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    sum[c] += factor * weights[c];
  }
  const double mean = factor * mean_of(weights);
  const std::array<double, 8> products{w.x, w.y, w.z, w.x * w.x, w.y * w.y, w.x * w.y, w.y * w.z, w.z * w.x};
  for (std::size_t i = 0; i < products.size(); ++i) {
    sum[kChannels + i] += mean * products[i];
  }
}

}  // namespace lamina
