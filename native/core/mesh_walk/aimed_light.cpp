// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/aimed_light.hpp"

#include <algorithm>
#include <numbers>

#include "phase/henyey_greenstein.hpp"

namespace lamina {

namespace {

constexpr double kReach = 8.0;       // mean free paths
constexpr double kNarrowest = 2e-3;  // radians
constexpr double kWidest = 0.9;      // of 1 - g
constexpr double kFourPi = 4.0 * std::numbers::pi;

}  // namespace

std::optional<AimedLight> AimedLight::at(const Scattering& scattering, const Lamp& lamp, const LampPoint& point,
                                         const MeshWalk& walk, WalkCounts& counts) {
  const LampLight light = lamp.light(scattering.place, point);
  const double reach = kReach / static_cast<double>(scattering.sample.extinction[scattering.leader]);
  // First guess: the face that the path met last, or the faces towards the lamp.
  Ray normal = scattering.normal;
  const bool faces = light.towards.dot(normal) > 0.0;
  const Ray first = faces ? -walk.boundary().inside(light.towards, normal) : light.towards;
  ++counts.rays;
  const auto found = walk.normal_towards(scattering.place, first, reach, scattering.shells);
  if (!found || light.irradiance == 0.0 || light.towards.dot(*found) <= 0.0) {
    return std::nullopt;
  }
  const Ray middle = -walk.boundary().inside(light.towards, *found);
  // Facets spread the light of one point of the lamp. A smooth boundary refracts only light of the entire lamp.
  const bool is_rough = walk.boundary().kind() == SurfaceBoundary::Kind::kRough;
  const double spread = is_rough ? walk.boundary().blur() : 0.5 * lamp.spread(scattering.place);
  const double parallax = reach / (kReach * light.distance);
  return AimedLight(middle, 1.0 - std::clamp(spread + parallax, kNarrowest, kWidest));
}

Ray AimedLight::sample(Rng& rng) const { return scattered(middle_, HenyeyGreenstein{g_}.sample(rng.uniform()), rng); }

double AimedLight::density(const Ray& direction) const {
  return HenyeyGreenstein{g_}.evaluate(middle_.dot(direction)) / kFourPi;
}

}  // namespace lamina
