// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the Legendre moments of a phase function decay.
#pragma once
#include <cmath>

namespace lamina {

/// Moments asked for at most: twice the nodes of the finest resolution, and some to spare.
inline constexpr int kMostMoments = 512;

/// peak() for phase functions whose moments do not fall as one power: the q whose powers fall below what a
/// solve can notice at the same order as the moments do. A peak too weak to be noticed does not count.
template <typename Phase>
double measured_peak(const Phase& phase) {
  // Measured: moments of this size left to delta-M change no value of a solve by more than 1e-4.
  constexpr double kUnnoticed = 2e-4;
  int last = kMostMoments;
  while (last > 0 && std::abs(phase.moment(last)) <= kUnnoticed) {
    --last;
  }
  if (last == 0) {
    return 0.0;
  }
  if (last == kMostMoments) {
    // Still above: what they fell to tells how slowly.
    return std::pow(std::abs(phase.moment(last)), 1.0 / last);
  }
  return std::pow(kUnnoticed, 1.0 / (last + 1));
}

}  // namespace lamina
