// SPDX-License-Identifier: GPL-3.0-or-later
// Where light of an oblique beam is before it is scattered.
#pragma once
#include <vector>

#include "lateral_walks/lateral_walk_stack.hpp"

namespace lamina {

/// Where light of an oblique beam is that has not been scattered yet. All its paths through smooth boundaries lie in
/// the plane of incidence; those that arrive at one place of the stack differ in how often they passed each medium.
/// A path is drawn backwards, from the arrival to the beam, each step in proportion to the power that came that way.
class UnscatteredPath {
 public:
  UnscatteredPath(const LateralWalkStack& stack, const WalkBeam& beam);

  /// Displacement in mm along the beam's azimuth of light that arrives at an element from above or from below; at
  /// element -1 from below: of what leaves above; one beyond the last from above: of what leaves below. Light must
  /// arrive there.
  double draw(std::ptrdiff_t element, bool from_above, Rng& rng) const;

 private:
  struct Step {
    double down = 0.0;    ///< power that arrives from above
    double up = 0.0;      ///< from below
    double shift = 0.0;   ///< in mm, by one passage
    double mirror = 0.0;  ///< share reflected
    bool turns = false;   ///< a boundary or a polished metal
  };
  std::vector<Step> steps_;
  bool straight_ = true;  ///< at normal incidence nothing is displaced
};

}  // namespace lamina
