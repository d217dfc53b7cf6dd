// SPDX-License-Identifier: GPL-3.0-or-later
// Russian roulette.
#pragma once
#include <cmath>

#include "numeric/rng.hpp"

namespace lamina {

/// Weights below the first number play Russian roulette; survivors get the second as weight, so the mean is unchanged.
inline constexpr double kRouletteBelow = 0.25;
inline constexpr double kRouletteKeeps = 0.5;

/// Plays Russian roulette; false if the walk ends. Weights may be negative.
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
