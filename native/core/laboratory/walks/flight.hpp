// SPDX-License-Identifier: GPL-3.0-or-later
// Next-event estimation along a free flight, integrated in closed form.
#pragma once
#include <cmath>

namespace lamina {

/// The integral over a flight in a layer of exp(-s) exp(-depth / mu_exit): the attenuation along the flight, and along
/// the exit beam. All lengths are optical.
///
/// A flight away from the exit face to the far face, `length` away. `kept_here` and `kept_there` are exp(-depth /
/// mu_exit) at its ends, `through` = exp(-length), `ratio` = mu of the flight / mu of the exit beam.
inline double flight_away(double kept_here, double kept_there, double through, double ratio) {
  return (kept_here - through * kept_there) / (1.0 + ratio);
}

/// A flight towards the exit face, `length` away along the flight and `depth` away along the exit beam.
/// `through` = exp(-length), `kept` = exp(-depth).
inline double flight_towards(double kept, double through, double depth, double length) {
  constexpr double kClose = 1e-3;  // the series errs by difference^4 / 1920 < 1e-15
  const double difference = length - depth;
  if (std::abs(difference) < kClose) {
    return length * std::sqrt(kept * through) * (1.0 + difference * difference / 24.0);
  }
  return length * (kept - through) / difference;
}

}  // namespace lamina
