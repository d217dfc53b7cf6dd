// SPDX-License-Identifier: GPL-3.0-or-later
// Red, green and blue of one quantity.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

namespace lamina {

inline constexpr std::size_t kChannels = 3;

using Channels = std::array<float, kChannels>;

/// Weights of a walk. Double precision, because a walk multiplies them thousands of times.
using Weights = std::array<double, kChannels>;

inline double mean_of(const Weights& weights) { return (weights[0] + weights[1] + weights[2]) * (1.0 / 3.0); }

inline float largest_of(const Channels& values) { return std::max({values[0], values[1], values[2]}); }

}  // namespace lamina
