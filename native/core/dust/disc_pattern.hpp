// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "numeric/rng.hpp"

namespace lamina {

/// Low-discrepancy points of the unit disc: uniform azimuths, and multiples of the golden ratio for the squared radius.
/// Each point of the surface rotates them by a random angle and shift (Cranley and Patterson 1976). The first quarter
/// of them, each fourth azimuth, is such a pattern too.
struct DiscPattern {
  static constexpr int kParts = 4;  // each as even as the whole

  std::vector<float> cosine, sine, square;

  explicit DiscPattern(int count) {
    for (int start = 0; start < kParts; ++start) {
      for (int i = start; i < count; i += kParts) {
        const double azimuth = 2.0 * std::numbers::pi * (i + 0.5) / count;
        cosine.push_back(static_cast<float>(std::cos(azimuth)));
        sine.push_back(static_cast<float>(std::sin(azimuth)));
        square.push_back(static_cast<float>(std::fmod(i * std::numbers::phi, 1.0)));
      }
    }
  }

  std::size_t size() const { return cosine.size(); }
};

/// The rotation and shift of a point's pattern, and a random number for Russian roulette.
struct DiscTurn {
  float cosine, sine, shift, chance;

  DiscTurn(std::uint64_t seed, std::uint64_t number) {
    Rng rng(seed, number);
    const double azimuth = 2.0 * std::numbers::pi * rng.uniform();
    cosine = static_cast<float>(std::cos(azimuth));
    sine = static_cast<float>(std::sin(azimuth));
    shift = static_cast<float>(rng.uniform());
    chance = static_cast<float>(rng.uniform());
  }
};

/// Points [first, first + count) of a turned pattern: x and y on the unit circle, and the squared radius.
inline void turned(const DiscPattern& pattern, const DiscTurn& turn, std::size_t first, std::size_t count, float* x,
                   float* y, float* square) {
  for (std::size_t i = 0; i < count; ++i) {
    const float c = pattern.cosine[first + i];
    const float s = pattern.sine[first + i];
    const float sum = pattern.square[first + i] + turn.shift;
    x[i] = c * turn.cosine - s * turn.sine;
    y[i] = s * turn.cosine + c * turn.sine;
    square[i] = sum >= 1.0F ? sum - 1.0F : sum;
  }
}

}  // namespace lamina
