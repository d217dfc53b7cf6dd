// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/stack_walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "walks/surface_meeting.hpp"

namespace lamina {

using Kind = WalkElements::Element::Kind;
using std::numbers::pi;

// Wider lobes are met often enough. Measured for a medium above metal: at .2, the smaller variance is worth the time.
constexpr double kWidestLobe = 0.2;  // alpha
// Largest probability that a path traced backwards goes on, and a factor of the densities of the ways: without it, the
// long paths of light that smooth boundaries hold would have weights without a bound. For such light in a sheet, .98
// has two fifths of the noise of .9.
constexpr double kMostOn = 0.98;
// Largest Exit::later. Paths with a larger one have weights below 1e-100 in the balance heuristic. Such paths exist:
// the compensation for the energy that facets lose samples directions in which the facets' own density may be 1e-240.
constexpr double kMostLater = 1e100;

StackWalk::StackWalk(WalkElements stack, const WalkTarget& target) : stack_(std::move(stack)), target_(target) {
  if (target.flux) {
    return;
  }
  // By reciprocity: trace a beam from the exit direction into the stack.
  const WalkBeam back(stack_, target.mu_o, target.dphi + pi, !target_is_above());
  exits_.resize(stack_.elements.size());
  add_exits(exits_, back, {{}, 1.0});
  // A base is the last element, and has nothing beyond.
  const bool top = target_is_above();
  const std::size_t count = stack_.elements.size();
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const std::size_t element = top ? k : count - 1 - k;
    if (stack_.elements[element].kind == Kind::kRough) {
      rough_.push_back(element);
    }
  }
  ends_rough_ = !rough_.empty() && rough_.front() == (top ? 0 : count - 1);
  has_rough_ = std::ranges::any_of(stack_.elements, [](const Element& one) { return one.kind == Kind::kRough; });
}

/// Adds the directions of a beam that was traced backwards. `like` has their common values.
void StackWalk::add_exits(std::vector<Exits>& sum, const WalkBeam& back, const Exit& like) {
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const WalkBeam::Arrival& arrival = back.at[k];
    if (arrival.at_top > 0.0) {
      sum[k].push_back({-arrival.down, like.share * arrival.at_top, like.later});
    }
    if (arrival.at_bottom > 0.0) {
      sum[k].push_back({-arrival.up, like.share * arrival.at_bottom, like.later});
    }
  }
}

/// Samples paths to the target direction through rough boundaries; false if there are none this time.
bool StackWalk::sample_boundaries(std::vector<Exits>& exits, Rng& rng) const {
  const bool top = target_is_above();
  bool found = false;
  for (const std::size_t boundary : rough_) {
    const Exits& here = exits[boundary];
    const auto out = std::ranges::find_if(here, [&](const Exit& one) { return one.is_up() == top; });
    if (out == here.end()) {
      break;
    }
    const ScatteringSurface::Outcome within = stack_.elements[boundary].facets->sample(-out->ray, rng);
    if (within.weight == 0.0 || (within.ray.z < 0.0) != top) {
      break;
    }
    add_exits(exits, WalkBeam(stack_, boundary, within.ray), {{}, out->share * within.weight});
    found = true;
  }
  return found;
}

/// Adds the paths to the target that were scattered by narrow facets before, for each known path.
void StackWalk::sample_lobes(std::vector<Exits>& exits, Rng& rng) const {
  for (std::size_t element = 0; element < exits.size(); ++element) {
    if (!is_narrow(element)) {
      continue;
    }
    Exits known = exits[element];
    std::erase_if(known, [](const Exit& one) { return !one.is_known(); });
    for (const Exit& out : known) {
      for (const bool reflected : {true, false}) {
        if (is_sampled(element, out, reflected)) {
          const ScatteringSurface& facets = *stack_.elements[element].facets;
          ScatteringSurface::Outcome before = facets.sample_once(-out.ray, reflected, rng);
          const double once = before.weight == 0.0 ? 0.0 : facets.value_once(-before.ray, out.ray);
          before.weight *= once == 0.0 ? 0.0 : facets.value(-before.ray, out.ray) / once;
          follow_back(element, out, before, exits, rng);
        }
      }
    }
  }
}

void StackWalk::follow_back(std::size_t element, Exit out, ScatteringSurface::Outcome before, std::vector<Exits>& exits,
                            Rng& rng) const {
  std::vector<std::pair<std::size_t, Exit>> next;
  while (before.weight != 0.0) {
    const ScatteringSurface& facets = *stack_.elements[element].facets;
    const double once = facets.value_once(-before.ray, out.ray);
    const double later = (1.0 + facets.value(-before.ray, out.ray) * out.later) / (kMostOn * once);
    if (!(later < kMostLater)) {
      return;
    }
    const WalkBeam back(stack_, element, before.ray);
    add_exits(exits, back, {{}, out.share * before.weight, later});

    // Choose one of the narrow facets that it meets
    next.clear();
    double whole = 0.0;
    for (std::size_t k = 0; k < exits.size(); ++k) {
      const int added = static_cast<int>(back.at[k].at_top > 0.0) + static_cast<int>(back.at[k].at_bottom > 0.0);
      for (auto one = exits[k].end() - added; is_narrow(k) && one != exits[k].end(); ++one) {
        next.emplace_back(k, *one);
        whole += one->share;
      }
    }
    const double kept = std::min(kMostOn, whole);
    if (next.empty() || rng.uniform() >= kept) {
      return;
    }
    double choice = rng.uniform() * whole;
    std::size_t chosen = 0;
    while (chosen + 1 < next.size() && choice >= next[chosen].second.share) {
      choice -= next[chosen++].second.share;
    }
    std::tie(element, out) = next[chosen];
    out.share = whole / kept;

    // Sample its lobes by their shares: a fixed choice of one would multiply the weight at each step
    before = stack_.elements[element].facets->sample(-out.ray, rng);
    if (!is_sampled(element, out, (before.ray.z > 0.0) == out.is_up())) {
      return;
    }
  }
}

bool StackWalk::is_narrow(std::size_t element) const {
  const Element& here = stack_.elements[element];
  return here.kind == Kind::kRough && here.facets->alpha() <= kWidestLobe;
}

/// True if walks sample light that facets scatter into this path.
bool StackWalk::is_sampled(std::size_t element, const Exit& out, bool reflected) const {
  const bool from_above = out.is_up() == reflected;
  const std::size_t elements = from_above ? element : stack_.elements.size() - 1 - element;
  return is_narrow(element) && elements > 0 && (reflected || !is_sampled_through(element, out));
}

/// True for light that crosses a rough boundary towards the target: see sample_boundaries.
bool StackWalk::is_sampled_through(std::size_t element, const Exit& out) const {
  return out.is_known() && out.is_up() == target_is_above() && std::ranges::find(rough_, element) != rough_.end();
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
  std::vector<Exits> sampled;
  double once = known_;
  if (has_lobes()) {
    sampled = exits_;
    if (!sample_boundaries(sampled, rng) && ends_rough_) {
      return known_;
    }
    sample_lobes(sampled, rng);
    once = 0.0;
    for (const Start& one : starts_) {
      once += one.arriving * first_leaving(one.element, sampled[one.element], one.in);
    }
  }
  const std::vector<Exits>& exits = sampled.empty() ? exits_ : sampled;
  static const Exits no_exits;
  double score = 0.0;
  Light light{starts_[start].in, 1.0};
  std::size_t element = starts_[start].element;
  bool first = true;
  while (meet(element, exits.empty() ? no_exits : exits[element], light, first, score, rng, events)) {
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
  return once + power_ * score;
}

bool StackWalk::meet(std::size_t element, const Exits& out, Light& light, bool first, double& score, Rng& rng,
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
    score += light.weight * met_leaving(element, out, light);
  }
  const Light in = light;
  const bool goes_on = scatter_at_surface(here, light.ray, light.weight, rng);
  if (goes_on && has_lobes()) {
    light.earlier = earlier(leaving_surface(stack_, element, in.ray, light.ray));
    if (is_narrow(element)) {
      light.earlier *= 1.0 + kMostOn * here.facets->value_once(in.ray, light.ray) * in.earlier;
    }
  }
  return goes_on;
}

/// The next events of light that was scattered elsewhere before.
double StackWalk::met_leaving(std::size_t element, const Exits& out, const Light& light) const {
  double sum = 0.0;
  for (const Exit& one : out) {
    const bool reflected = one.is_up() == (light.ray.z < 0.0);
    if (!reflected && is_sampled_through(element, one)) {
      continue;
    }
    const double value = leaving_surface(stack_, element, light.ray, one.ray);
    double ways = 1.0 + value * one.later;
    if (is_sampled(element, one, reflected)) {
      ways += kMostOn * stack_.elements[element].facets->value_once(light.ray, one.ray) * light.earlier;
    }
    sum += one.share * value / ways;
  }
  return sum;
}

double StackWalk::first_leaving(std::size_t element, const Exits& out, const Ray& in) const {
  return stack_.elements[element].kind == Kind::kMedium ? leaving(element, out, in) : surface_leaving(element, out, in);
}

double StackWalk::surface_leaving(std::size_t element, const Exits& out, const Ray& in) const {
  double sum = 0.0;
  for (const Exit& one : out) {
    sum += one.share * one.weighed(leaving_surface(stack_, element, in, one.ray));
  }
  return sum;
}

}  // namespace lamina
