// SPDX-License-Identifier: GPL-3.0-or-later
// The decay rate of the Legendre moments of a phase function.
#pragma once
#include <cmath>

namespace lamina {

/// Largest number of moments: twice the nodes of the finest resolution, and a margin.
inline constexpr int kMostMoments = 512;

/// peak() of a phase function whose moments do not decay as a single power: the q for which q^l falls below the
/// noticeable size at the same l as the moments. Ignores a peak that is too weak to be noticed.
template <typename Phase>
double measured_peak(const Phase& phase) {
  // Measured: truncating moments of this size (delta-M) changes no solved value by more than 1e-4.
  constexpr double kUnnoticed = 2e-4;
  int last = kMostMoments;
  while (last > 0 && std::abs(phase.moment(last)) <= kUnnoticed) {
    --last;
  }
  if (last == 0) {
    return 0.0;
  }
  if (last == kMostMoments) {
    // Still above at the last order: derive the rate from the last moment.
    return std::pow(std::abs(phase.moment(last)), 1.0 / last);
  }
  return std::pow(kUnnoticed, 1.0 / (last + 1));
}

}  // namespace lamina
