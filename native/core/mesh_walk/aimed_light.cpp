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
// The directions are drawn from two lobes. The narrow one fits flat faces. Where the light arrives through another face
// than the guessed one, on curved surfaces, directions far from the middle count much: the wide lobe draws them often
// enough. Measured on a bumpy ball of marble: half the variance of a narrow lobe alone.
constexpr double kNarrow = 1.5;     // 1 - g of the narrow lobe, relative to the spread of the light
constexpr double kWide = 8.0;       // 1 - g of the wide lobe, relative to the narrow lobe
constexpr double kWideShare = 0.4;  // of the directions
constexpr double kFourPi = 4.0 * std::numbers::pi;

}  // namespace

std::optional<AimedLight> AimedLight::at(const Scattering& scattering, const Lamp& lamp, const LampPoint& point,
                                         const MeshWalk& walk, WalkCounts& counts) {
  const LampLight light = lamp.light(scattering.place, point);
  const double reach = kReach / static_cast<double>(scattering.sample.extinction[scattering.leader]);
  if (walk.clearance(scattering.place) > reach) {
    return std::nullopt;
  }
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
  const double narrow = std::clamp(kNarrow * (spread + parallax), kNarrowest, kWidest);
  return AimedLight(middle, 1.0 - narrow, 1.0 - std::min(kWide * narrow, kWidest));
}

Ray AimedLight::sample(Rng& rng) const {
  const double g = rng.uniform() < kWideShare ? wide_ : narrow_;
  return scattered(middle_, HenyeyGreenstein{g}.sample(rng.uniform()), rng);
}

double AimedLight::density(const Ray& direction) const {
  const double cosine = middle_.dot(direction);
  const double narrow = HenyeyGreenstein{narrow_}.evaluate(cosine);
  return (narrow + kWideShare * (HenyeyGreenstein{wide_}.evaluate(cosine) - narrow)) / kFourPi;
}

}  // namespace lamina
