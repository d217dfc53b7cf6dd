// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/stack_walk.hpp"

#include <cmath>
#include <numbers>

#include "walks/surface_meeting.hpp"

namespace lamina {

using Kind = WalkElements::Element::Kind;
using std::numbers::pi;

StackWalk::StackWalk(WalkElements stack, const WalkTarget& target) : stack_(std::move(stack)), target_(target) {
  if (target.flux) {
    return;
  }
  // By reciprocity: trace a beam from the exit direction into the stack.
  const WalkBeam back(stack_, target.mu_o, target.dphi + pi, target.path == Path::kTransmit);
  exits_ = exits_from(back);
  // A base is the last element, and has nothing beyond.
  const bool top = target.path == Path::kReflect;
  const std::size_t count = stack_.elements.size();
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const std::size_t element = top ? k : count - 1 - k;
    if (stack_.elements[element].kind == Kind::kRough) {
      rough_.push_back(element);
    }
  }
  ends_rough_ = !rough_.empty() && rough_.front() == (top ? 0 : count - 1);
}

std::vector<StackWalk::Exit> StackWalk::exits_from(const WalkBeam& back) const {
  std::vector<Exit> exits;
  for (const WalkBeam::Arrival& arrival : back.at) {
    exits.push_back({-arrival.down, -arrival.up, arrival.at_top, arrival.at_bottom});
  }
  return exits;
}

/// Adds to `sum` the directions that only `more` has.
void StackWalk::add_exit(Exit& sum, const Exit& more) {
  if (more.up_share > 0.0) {
    sum.up = more.up;
    sum.up_share = more.up_share;
  }
  if (more.down_share > 0.0) {
    sum.down = more.down;
    sum.down_share = more.down_share;
  }
}

/// Samples paths to the target direction through rough boundaries; false if there are none this time.
bool StackWalk::sample_exits(std::vector<Exit>& beyond, Rng& rng) const {
  const bool top = target_.path == Path::kReflect;
  beyond.assign(exits_.size(), {});
  bool found = false;
  for (const std::size_t boundary : rough_) {
    const Exit& out = found ? beyond[boundary] : exits_[boundary];
    const double share = top ? out.up_share : out.down_share;
    if (share == 0.0) {
      break;
    }
    const FacetScatter::Outcome within = stack_.elements[boundary].facets->sample(-(top ? out.up : out.down), rng);
    if (within.weight == 0.0 || (within.ray.z < 0.0) != top) {
      break;
    }
    const std::vector<Exit> more = exits_from(WalkBeam(stack_, boundary, within.ray));
    const double lobe = share * within.weight;
    for (std::size_t k = 0; k < more.size(); ++k) {
      const Exit& one = more[k];
      add_exit(beyond[k], {one.up, one.down, lobe * one.up_share, lobe * one.down_share});
    }
    found = true;
  }
  return found;
}

void StackWalk::begin() {
  const WalkBeam beam(stack_, target_.mu_i, 0.0, false);
  if (target_.flux) {
    known_ = target_.path == Path::kReflect ? beam.reflected : beam.transmitted;
  }
  for (std::size_t k = 0; k < beam.at.size(); ++k) {
    add_start(k, beam.at[k].down, beam.at[k].at_top);
    add_start(k, beam.at[k].up, beam.at[k].at_bottom);
  }
}

void StackWalk::add_start(std::size_t element, const Ray& in, double power) {
  const Element& here = stack_.elements[element];
  if (power == 0.0 || here.is_polished()) {
    return;
  }
  const bool medium = here.kind == Kind::kMedium;
  if (!target_.flux) {
    known_ += power * first_leaving(element, exits_[element], in);
  }
  const double scattered = power * (medium ? scattered_share(element, in) : 1.0);
  if (scattered > 0.0) {
    power_ += scattered;
    starts_.push_back({element, in, power, power_});
  }
}

double StackWalk::sample(Rng& rng, std::uint64_t& events) const {
  if (starts_.empty()) {
    return known_;
  }
  std::size_t start = 0;
  if (starts_.size() > 1) {
    const double choice = rng.uniform() * power_;
    while (start + 1 < starts_.size() && starts_[start].until < choice) {
      ++start;
    }
  }
  std::vector<Exit> sampled;
  double before = 0.0;  // first scattering, into the sampled directions of lobes
  if (!rough_.empty() && !target_.flux) {
    const bool found = sample_exits(sampled, rng);
    if (ends_rough_ && !found) {
      return known_;
    }
    for (const Start& one : starts_) {
      before += one.arriving * first_leaving(one.element, sampled[one.element], one.in);
    }
    for (std::size_t k = 0; !ends_rough_ && k < sampled.size(); ++k) {
      add_exit(sampled[k], exits_[k]);  // their first scattering is known
    }
  }
  const std::vector<Exit>& exits = sampled.empty() ? exits_ : sampled;
  static constexpr Exit kNone = {};
  double score = 0.0;
  Light light{starts_[start].in, 1.0};
  std::size_t element = starts_[start].element;
  bool first = true;
  while (meet(element, exits.empty() ? kNone : exits[element], light, first, score, rng, events)) {
    first = false;
    const bool down = light.ray.z < 0.0;
    if (down ? element + 1 == stack_.elements.size() : element == 0) {
      if (target_.flux && down == (target_.path == Path::kTransmit)) {
        score += light.weight;
      }
      break;
    }
    element += down ? 1 : std::size_t(-1);
  }
  return known_ + before + power_ * score;
}

bool StackWalk::meet(std::size_t element, const Exit& out, Light& light, bool first, double& score, Rng& rng,
                     std::uint64_t& events) const {
  const Element& here = stack_.elements[element];
  if (here.kind == Kind::kMedium) {
    return cross(element, out, light, first, score, rng, events);
  }
  if (here.is_polished()) {
    return meet_polished(stack_, element, light.ray, light.weight, rng);
  }
  ++events;
  if (!first && !target_.flux) {
    Exit left = out;
    if (here.kind == Kind::kRough && element + 1 < stack_.elements.size()) {
      // Counted before, see sample_exits: light that crosses the boundary towards the target.
      const bool top = target_.path == Path::kReflect;
      if ((light.ray.z > 0.0) == top) {
        (top ? left.up_share : left.down_share) = 0.0;
      }
    }
    score += light.weight * surface_leaving(element, left, light.ray);
  }
  return scatter_at_surface(here, light.ray, light.weight, rng);
}

double StackWalk::first_leaving(std::size_t element, const Exit& out, const Ray& in) const {
  return stack_.elements[element].kind == Kind::kMedium ? leaving(element, out, in) : surface_leaving(element, out, in);
}

double StackWalk::surface_leaving(std::size_t element, const Exit& out, const Ray& in) const {
  double sum = 0.0;
  if (out.up_share > 0.0) {
    sum += out.up_share * leaving_surface(stack_, element, in, out.up);
  }
  if (out.down_share > 0.0) {
    sum += out.down_share * leaving_surface(stack_, element, in, out.down);
  }
  return sum;
}

}  // namespace lamina
