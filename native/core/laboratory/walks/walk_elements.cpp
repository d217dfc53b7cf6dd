// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/walk_elements.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "events/facet_scatter.hpp"
#include "events/measured_scatter.hpp"
#include "matter/smooth_boundary.hpp"
#include "operators/delta_field.hpp"

namespace lamina {
namespace {

using Element = WalkElements::Element;
using Kind = Element::Kind;

/// Thickness in transport lengths at which a conservative layer equals an infinite one within rounding.
constexpr double kEffectivelyInfinite = 30.0;

/// `reversed`: the stack is upside down.
Element element_of(const Layer& layer, double ior_above, double ior_below, double turn, bool reversed) {
  Element element;
  if (const auto* medium = std::get_if<Medium>(&layer)) {
    element.medium = *medium;
    return element;
  }
  if (const auto* graded = std::get_if<GradedMedium>(&layer)) {
    element.medium = {graded->largest_albedo(), graded->tau(), graded->sharpest_phase()};
    element.graded = std::make_shared<const GradedMedium>(*graded);
    return element;
  }
  const auto& boundary = std::get<Interface>(layer);
  element.kind = Kind::kSmooth;
  element.from_above = reversed ? boundary.optics(ior_below).turned() : boundary.optics(ior_above);
  element.from_below = element.from_above.turned();
  if (boundary.is_rough(reversed ? ior_below : ior_above)) {
    element.kind = Kind::kRough;
    element.facets = std::make_shared<FacetScatter>(boundary.facets.turned(turn), element.from_above);
  }
  return element;
}

Element element_of(const Base& base, double ior_above, double turn) {
  Element element;
  element.kind = Kind::kLambert;
  element.reflectance = base.reflectance;
  if (base.is_mirror()) {
    element.kind = Kind::kMirror;
    element.mirror = base;
  } else if (base.is_rough()) {
    element.kind = Kind::kRough;
    if (base.measured) {
      element.facets = std::make_shared<MeasuredScatter>(base, ior_above);
    } else {
      element.facets = std::make_shared<FacetScatter>(base.facets.turned(turn), base.optics(ior_above));
    }
  }
  return element;
}

}  // namespace

WalkElements::WalkElements(const Stack& stack, const WalkTarget& target, bool ended) : ior(refractive_indices(stack)) {
  const Side side = target.side;
  if (side == Side::kBottom && stack.base.kind != Base::Kind::kNone) {
    throw std::invalid_argument("side = 'bottom': must be 'top' for a stack with a base");
  }
  std::vector<Layer> layers = stack.layers;
  if (side == Side::kBottom) {
    std::reverse(layers.begin(), layers.end());
    std::reverse(ior.begin(), ior.end());
    for (Layer& layer : layers) {
      if (auto* graded = std::get_if<GradedMedium>(&layer)) {
        *graded = graded->turned();
      }
    }
  }
  for (std::size_t k = 0; k < layers.size(); ++k) {
    elements.push_back(element_of(layers[k], ior[k], ior[k + 1], target.turn(), side == Side::kBottom));
    Medium& medium = elements.back().medium;
    if (elements.back().kind == Kind::kMedium && std::isinf(medium.tau)) {
      // Elements below an infinite medium have no effect.
      ior.resize(k + 2);
      Element end;
      end.kind = Kind::kLambert;
      if (ended && medium.albedo == 1.0) {
        medium.tau = kEffectivelyInfinite / (1.0 - medium.phase.moment(1));
        end.reflectance = 1.0;
      }
      elements.push_back(std::move(end));
      ior.push_back(ior.back());
      return;
    }
  }
  if (stack.base.kind != Base::Kind::kNone) {
    elements.push_back(element_of(stack.base, ior.back(), target.turn()));
    ior.push_back(ior.back());
  }
}

WalkBeam::WalkBeam(const WalkElements& stack, double mu, double phi, bool from_below) {
  pass(stack, 0, stack.elements.size(), sine_of(mu), {std::cos(phi), std::sin(phi), mu}, from_below);
}

WalkBeam::WalkBeam(const WalkElements& stack, std::size_t from, const Ray& within) {
  const bool down = within.z < 0.0;
  const double across = std::hypot(within.x, within.y);
  const Ray heading = across > 0.0 ? Ray{within.x / across, within.y / across, 0.0} : Ray{1.0, 0.0, 0.0};
  pass(stack, down ? from + 1 : 0, down ? stack.elements.size() : from, across * stack.ior[down ? from + 1 : from],
       heading, !down);
  // The light that returns to the element where the beam started.
  const Ray back{within.x, within.y, -within.z};
  at[from] = down ? Arrival{{}, back, 0.0, reflected} : Arrival{back, {}, reflected, 0.0};
}

void WalkBeam::pass(const WalkElements& stack, std::size_t first, std::size_t last, double sine, const Ray& heading,
                    bool from_below) {
  // Snell's law keeps n sin(theta).
  const auto cosine = [&](std::size_t gap) { return sine_of(sine / stack.ior[gap]); };
  // An empty element at each end collects the light that leaves.
  const auto empty = DeltasOf<1>::nothing(1);
  std::vector<DeltasOf<1>> deltas{empty};
  deltas.reserve(last - first + 2);
  for (std::size_t k = first; k < last; ++k) {
    const Element& element = stack.elements[k];
    DeltasOf<1> s{DeltasOf<1>::Share(0.0), DeltasOf<1>::Share(0.0), DeltasOf<1>::Share(0.0)};
    if (element.kind == Kind::kMedium) {
      const Medium& medium = element.medium;
      const double extinction = medium.flakes ? medium.flakes->extinction(cosine(k)) : 1.0;
      s.transmit[0] = std::exp(-medium.tau * extinction / cosine(k));
    } else if (element.kind == Kind::kSmooth) {
      // A cosine of 0 means that the ray does not exist there.
      const SmoothBoundary boundary(element.from_above, cosine(k), cosine(k + 1));
      s.reflect_above[0] = boundary.above;
      s.reflect_below[0] = boundary.below;
      s.transmit[0] = boundary.passed;
    } else if (element.kind == Kind::kMirror) {
      s.reflect_above[0] = element.mirror.mirror_reflectance(cosine(k), stack.ior[k]);
    }
    deltas.push_back(s);
  }
  deltas.push_back(empty);
  const DeltaFieldOf<1> field(deltas);
  const auto& arrivals = from_below ? field.from_below : field.from_above;
  const auto ray = [&](std::size_t gap, double turn) -> Ray {
    const double across = sine / stack.ior[gap];
    return {across * heading.x, across * heading.y, turn * cosine(gap)};
  };
  at.resize(stack.elements.size());
  for (std::size_t k = first; k < last; ++k) {
    const auto& arrival = arrivals[k - first + 1];
    at[k] = {ray(k, -1.0), ray(k + 1, 1.0), arrival.down[0], arrival.up[0]};
  }
  const double to_top = arrivals.front().up[0];
  const double to_bottom = arrivals.back().down[0];
  reflected = from_below ? to_bottom : to_top;
  transmitted = from_below ? to_top : to_bottom;
}

}  // namespace lamina
