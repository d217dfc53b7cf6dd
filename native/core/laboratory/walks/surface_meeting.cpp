// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/surface_meeting.hpp"

#include <cmath>
#include <numbers>

#include "events/survival.hpp"

namespace lamina {
namespace {

using Kind = WalkElements::Element::Kind;
using std::numbers::pi;

/// Returns the share of the light that a film does not absorb.
double meet_smooth(const FacetOptics& optics, Ray& ray, Rng& rng) {
  if (optics.here == optics.beyond && !optics.film) {
    return 1.0;
  }
  const double ratio = optics.here / optics.beyond;
  const double mu = std::abs(ray.z);
  const double sine2 = (1.0 - mu * mu) * ratio * ratio;
  double kept = 1.0;
  if (sine2 < 1.0) {
    const double refracted = std::sqrt(1.0 - sine2);
    const double reflected = optics.film ? optics.reflectance(mu) : fresnel(mu, refracted, optics.here, optics.beyond);
    if (rng.uniform() >= reflected) {
      ray = {ray.x * ratio, ray.y * ratio, std::copysign(refracted, ray.z)};
      return optics.film ? optics.transmittance(mu) / (1.0 - reflected) : 1.0;
    }
  } else if (optics.film) {
    kept = optics.reflectance(mu);
  }
  ray = ray.mirrored();
  return kept;
}

}  // namespace

bool meet_polished(const WalkElements& stack, std::size_t element, Ray& ray, double& weight, Rng& rng) {
  const WalkElements::Element& here = stack.elements[element];
  if (here.kind == Kind::kSmooth) {
    const double kept = meet_smooth(ray.z < 0.0 ? here.from_above : here.from_below, ray, rng);
    weight *= kept;
    return kept == 1.0 || survives(weight, rng);
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
    const ScatteringSurface::Outcome outcome = surface.facets->sample(ray, rng);
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
