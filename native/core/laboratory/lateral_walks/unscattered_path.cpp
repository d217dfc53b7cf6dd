// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral_walks/unscattered_path.hpp"

#include <cmath>

#include "matter/fresnel.hpp"

namespace lamina {

using Kind = WalkElements::Element::Kind;

UnscatteredPath::UnscatteredPath(const LateralWalkStack& stack, const WalkBeam& beam) {
  const WalkElements& walked = stack.walked;
  for (std::size_t k = 0; k < walked.elements.size(); ++k) {
    const WalkBeam::Arrival& arrival = beam.at[k];
    Step step{arrival.at_top, arrival.at_bottom};
    const double mu = -arrival.down.z;
    const Kind kind = walked.elements[k].kind;
    if (kind == Kind::kMedium && arrival.down.x > 0.0) {
      const DepthScale& scale = stack.scales[k];
      const double optical = walked.elements[k].medium.tau / mu;
      step.shift = arrival.down.x * scale.length(scale.top(), scale.bottom(), optical, mu);
      straight_ = false;
    } else if (kind == Kind::kSmooth) {
      const double below = arrival.up.z;
      step.turns = true;
      step.mirror = mu > 0.0 && below > 0.0 ? fresnel(mu, below, walked.ior[k], walked.ior[k + 1]) : 1.0;
    } else if (kind == Kind::kMirror) {
      step.turns = true;
      step.mirror = 1.0;
    }
    steps_.push_back(step);
  }
}

double UnscatteredPath::draw(std::ptrdiff_t element, bool from_above, Rng& rng) const {
  double place = 0.0;
  if (straight_) {
    return place;
  }
  for (;;) {
    if (from_above && element == 0) {
      return place;
    }
    // Go back to the element that the light met last.
    element += from_above ? -1 : 1;
    const Step& last = steps_[static_cast<std::size_t>(element)];
    if (!last.turns) {
      place += last.shift;
      continue;
    }
    const double through = (1.0 - last.mirror) * (from_above ? last.down : last.up);
    const double back = last.mirror * (from_above ? last.up : last.down);
    if (rng.uniform() * (through + back) < back) {
      from_above = !from_above;
    }
  }
}

}  // namespace lamina
