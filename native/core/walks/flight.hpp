// SPDX-License-Identifier: GPL-3.0-or-later
// Free flights of a photon walk: their sampling and their scores.
#pragma once
#include <cmath>

namespace lamina {

/// For a flight in a layer, between two places in the layer: integral over the flight of exp(-length) times what an
/// exit beam keeps, exp(-depth / mu_exit), in optical lengths.
///
/// Away from the exit face: from a place where the exit beam keeps `kept_here` to the far face, `length` away, where
/// it keeps `kept_there`; `ratio` = mu of the flight / mu of the exit beam, `through` = exp(-length).
inline double flight_away(double kept_here, double kept_there, double through, double ratio) {
  return (kept_here - through * kept_there) / (1.0 + ratio);
}

/// Towards the exit face, `length` away along the flight and `depth` along the exit beam: through = exp(-length),
/// kept = exp(-depth).
inline double flight_towards(double kept, double through, double depth, double length) {
  constexpr double kClose = 1e-3;
  const double difference = length - depth;
  if (std::abs(difference) < kClose) {
    return length * std::sqrt(kept * through) * (1.0 + difference * difference / 24.0);
  }
  return length * (kept - through) / difference;
}

}  // namespace lamina
