// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of an oblique beam's light before its first scattering.
#pragma once
#include <vector>

#include "lateral_walks/lateral_walk_stack.hpp"

namespace lamina {

/// Samples the position of light of an oblique beam that has not been scattered yet. All its paths through smooth
/// boundaries lie in the plane of incidence; paths to the same element differ in how often they passed each medium. A
/// path is sampled backwards, from the arrival to the beam, with probabilities in proportion to the power of each step.
class UnscatteredPath {
 public:
  UnscatteredPath(const LateralWalkStack& stack, const WalkBeam& beam);

  /// Displacement in mm along the beam's azimuth of light that arrives at an element, from above or from below. Element
  /// -1 from below is light that leaves above; the element after the last, from above, is light that leaves below.
  /// Requires that light arrives there.
  double draw(std::ptrdiff_t element, bool from_above, Rng& rng) const;

 private:
  struct Step {
    double down = 0.0;    ///< power that arrives from above
    double up = 0.0;      ///< power that arrives from below
    double shift = 0.0;   ///< displacement in mm by one passage
    double mirror = 0.0;  ///< reflectance
    bool turns = false;   ///< true for a smooth boundary or a smooth conductor
  };
  std::vector<Step> steps_;
  bool straight_ = true;  ///< true at normal incidence, where nothing is displaced
};

}  // namespace lamina
