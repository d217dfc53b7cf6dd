// SPDX-License-Identifier: GPL-3.0-or-later
// Inverts an increasing function by bracketed Newton iteration.
#pragma once
#include <cmath>

namespace lamina {

/// A function's value and slope at one point.
struct ValueAndSlope {
  double value;
  double slope;
};

/// The root of an increasing function in [low, high], to rounding: Newton iteration from `start`, with bisection where
/// a step leaves the bracket. `function` returns ValueAndSlope; its values are of order 1 over the range.
template <typename Function>
double invert_increasing(const Function& function, double low, double high, double start) {
  constexpr int kMostSteps = 80;
  constexpr double kRounding = 2e-16;
  const double narrow = 1e-15 * (high - low);
  double x = start;
  for (int step = 0; step < kMostSteps && high - low > narrow; ++step) {
    const ValueAndSlope f = function(x);
    if (std::abs(f.value) <= kRounding) {
      return x;
    }
    (f.value < 0.0 ? low : high) = x;
    const double newton = x - f.value / f.slope;
    const bool held = newton > low && newton < high;
    const double next = held ? newton : 0.5 * (low + high);
    if (held && std::abs(next - x) <= narrow) {
      return next;
    }
    x = next;
  }
  return x;
}

}  // namespace lamina
