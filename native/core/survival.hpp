// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "rng.hpp"

namespace lamina {

/// Weights below the first are played for: kept at the second with the probability that leaves the mean as it is.
inline constexpr double kRouletteBelow = 0.25;
inline constexpr double kRouletteKeeps = 0.5;

/// Russian roulette; false when the walk ends.
inline bool survives(double& weight, Rng& rng) {
  if (weight >= kRouletteBelow) {
    return true;
  }
  if (rng.uniform() * kRouletteKeeps >= weight) {
    return false;
  }
  weight = kRouletteKeeps;
  return true;
}

}  // namespace lamina
