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
  const std::size_t last = target.path == Path::kReflect ? 0 : stack_.elements.size() - 1;
  if (stack_.elements.size() > 1 && stack_.elements[last].kind == Kind::kRough) {
    rough_exit_ = last;
  }
}

std::vector<StackWalk::Exit> StackWalk::exits_from(const WalkBeam& back) const {
  std::vector<Exit> exits;
  for (const WalkBeam::Arrival& arrival : back.at) {
    exits.push_back({-arrival.down, -arrival.up, arrival.at_top, arrival.at_bottom});
  }
  return exits;
}

double StackWalk::sample_exits(std::vector<Exit>& exits, Rng& rng) const {
  const bool top = target_.path == Path::kReflect;
  const Exit& out = exits_[*rough_exit_];
  const FacetScatter::Outcome within = stack_.elements[*rough_exit_].facets->sample(-(top ? out.up : out.down), rng);
  if (within.weight == 0.0 || (within.ray.z < 0.0) != top) {
    return 0.0;
  }
  exits = exits_from(WalkBeam(stack_, *rough_exit_, within.ray));
  return within.weight;
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
  double before = 0.0;  // first scattering, into the sampled direction of the lobe
  double lobe = 1.0;
  if (rough_exit_) {
    lobe = sample_exits(sampled, rng);
    if (lobe == 0.0) {
      return known_;
    }
    for (const Start& one : starts_) {
      before += one.arriving * first_leaving(one.element, sampled[one.element], one.in);
    }
  }
  const std::vector<Exit>& exits = rough_exit_ ? sampled : exits_;
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
  return known_ + lobe * (before + power_ * score);
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
    score += light.weight * surface_leaving(element, out, light.ray);
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
