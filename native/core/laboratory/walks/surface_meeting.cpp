// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/surface_meeting.hpp"

#include <cmath>
#include <numbers>

#include "events/survival.hpp"
#include "matter/fresnel.hpp"

namespace lamina {
namespace {

using Kind = WalkElements::Element::Kind;
using std::numbers::pi;

void meet_smooth(const WalkElements& stack, std::size_t element, Ray& ray, Rng& rng) {
  const bool down = ray.z < 0.0;
  const double from = stack.ior[down ? element : element + 1];
  const double to = stack.ior[down ? element + 1 : element];
  if (from == to) {
    return;
  }
  const double ratio = from / to;
  const double mu = std::abs(ray.z);
  const double sine2 = (1.0 - mu * mu) * ratio * ratio;
  if (sine2 < 1.0) {
    const double refracted = std::sqrt(1.0 - sine2);
    if (rng.uniform() >= fresnel(mu, refracted, from, to)) {
      ray = {ray.x * ratio, ray.y * ratio, std::copysign(refracted, ray.z)};
      return;
    }
  }
  ray = ray.mirrored();
}

}  // namespace

bool meet_polished(const WalkElements& stack, std::size_t element, Ray& ray, double& weight, Rng& rng) {
  const WalkElements::Element& here = stack.elements[element];
  if (here.kind == Kind::kSmooth) {
    meet_smooth(stack, element, ray, rng);
    return true;
  }
  weight *= here.mirror.mirror_reflectance(-ray.z, stack.ior[element]);
  ray = ray.mirrored();
  return survives(weight, rng);
}

bool scatter_at_surface(const WalkElements::Element& surface, Ray& ray, double& weight, Rng& rng) {
  if (surface.kind == Kind::kLambert) {
    weight *= surface.reflectance;
    ray = lambert_ray(rng);
  } else {
    const FacetScatter::Outcome outcome = surface.facets->sample(ray, rng);
    weight *= outcome.weight;
    ray = outcome.ray;
  }
  return weight != 0.0 && survives(weight, rng);
}

double leaving_surface(const WalkElements& stack, std::size_t element, const Ray& in, const Ray& out) {
  const WalkElements::Element& surface = stack.elements[element];
  if (surface.kind == Kind::kLambert) {
    return out.z > 0.0 ? surface.reflectance / (pi * stack.ior[element] * stack.ior[element]) : 0.0;
  }
  return surface.facets->value(in, out);
}

}  // namespace lamina
