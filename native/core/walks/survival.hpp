// SPDX-License-Identifier: GPL-3.0-or-later
// Russian roulette of walks.
#pragma once
#include <cmath>

#include "numeric/rng.hpp"

namespace lamina {

/// Weights below the first are played for: kept at the second with the probability that leaves the mean as it is.
inline constexpr double kRouletteBelow = 0.25;
inline constexpr double kRouletteKeeps = 0.5;

/// Russian roulette; false when the walk ends. Weights may be negative.
inline bool survives(double& weight, Rng& rng) {
  if (std::abs(weight) >= kRouletteBelow) {
    return true;
  }
  if (rng.uniform() * kRouletteKeeps >= std::abs(weight)) {
    return false;
  }
  weight = std::copysign(kRouletteKeeps, weight);
  return true;
}

}  // namespace lamina
