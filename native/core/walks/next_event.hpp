// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of next-event estimation of the transfer walk.
#pragma once
#include <cmath>

#include "phase/phase.hpp"

namespace lamina {

/// How the transfer walk adds what leaves without another event.
enum class NextEvent {
  /// As kAlongFlight, on two flights from each collision: one scattered from the ray, along which the walk goes on, and
  /// one scattered backwards from the exit. Their samples are weighted by both densities (the balance heuristic
  /// of Veach and Guibas 1995), so that neither peak of the phase function makes a large one.
  kFromBothEnds,
  kAlongFlight,  ///< at every point of each flight, integrated in closed form: collisions on it need not happen
  kFitting,      ///< the first for media that scatter mostly forwards or backwards, else the second, which is faster
  kAtCollision,  ///< at the end of each flight that collides: the textbook's way
};

/// What kFitting means for a phase function. Measured at mean cosines 0, .75 and .9: 1.4 times slower, and 1.4 and
/// 2 times faster.
inline NextEvent fitted(NextEvent next_event, const PhaseFunction& phase) {
  constexpr double kPeaked = 0.4;
  if (next_event != NextEvent::kFitting) {
    return next_event;
  }
  return std::abs(phase.moment(1)) > kPeaked ? NextEvent::kFromBothEnds : NextEvent::kAlongFlight;
}

/// The product of the phase function's values from the ray and from the exit, weighted for a direction that either
/// may have sampled.
inline double both_ends(double from_ray, double from_exit) {
  const double sum = from_ray + from_exit;
  return sum > 0.0 ? from_ray * from_exit / sum : 0.0;
}

}  // namespace lamina
