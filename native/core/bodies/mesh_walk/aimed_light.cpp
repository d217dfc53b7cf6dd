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
constexpr double kNear = 0.25;      // angle between equal guesses, relative to 1 - g of the narrow lobe
constexpr double kFourPi = 4.0 * std::numbers::pi;

}  // namespace

std::optional<AimedLight> AimedLight::at(const Scattering& scattering, const Lamp& lamp, const LampPoint& point,
                                         const MeshWalk& walk, WalkCounts& counts) {
  const LampLight light = lamp.light(scattering.place, point);
  const double reach = kReach / static_cast<double>(scattering.sample.extinction[scattering.leader]);
  if (walk.clearance(scattering.place) > reach) {
    return std::nullopt;
  }
  // Facets spread the light of one point of the lamp. A smooth boundary refracts only light of the entire lamp.
  const bool is_rough = walk.boundary().kind() == SurfaceBoundary::Kind::kRough;
  const double spread = is_rough ? walk.boundary().blur() : 0.5 * lamp.spread(scattering.place);
  const double parallax = reach / (kReach * light.distance);
  const double narrow = std::clamp(kNarrow * (spread + parallax), kNarrowest, kWidest);
  AimedLight aim(1.0 - narrow, 1.0 - std::min(kWide * narrow, kWidest));
  // First guess: the face that the path met last, or the faces towards the lamp. Then the face that the refracted light
  // of the last guess would pass, until guesses repeat. Where faces differ, light may arrive through each of them.
  const double near = 1.0 - 0.5 * (kNear * narrow) * (kNear * narrow);
  const bool faces = light.towards.dot(scattering.normal) > 0.0;
  Ray direction = faces ? -walk.boundary().inside(light.towards, scattering.normal) : light.towards;
  while (light.irradiance > 0.0 && aim.guesses_ < kMostGuesses) {
    ++counts.rays;
    const auto found = walk.normal_towards(scattering.place, direction, reach, scattering.shells);
    if (!found || light.towards.dot(*found) <= 0.0) {
      break;
    }
    const Ray guess = -walk.boundary().inside(light.towards, *found);
    const auto is_near = [&](const Ray& other) { return other.dot(guess) > near; };
    if (std::any_of(aim.middles_.begin(), aim.middles_.begin() + aim.guesses_, is_near)) {
      break;
    }
    aim.middles_[static_cast<std::size_t>(aim.guesses_++)] = guess;
    if (is_near(direction)) {
      break;
    }
    direction = guess;
  }
  return aim.guesses_ > 0 ? std::optional(aim) : std::nullopt;
}

Ray AimedLight::sample(Rng& rng) const {
  if (rng.uniform() < kWideShare) {
    return scattered(middles_[last()], HenyeyGreenstein{wide_}.sample(rng.uniform()), rng);
  }
  const auto guess = static_cast<std::size_t>(rng.uniform() * guesses_);
  return scattered(middles_[guess], HenyeyGreenstein{narrow_}.sample(rng.uniform()), rng);
}

double AimedLight::density(const Ray& direction) const {
  double narrow = 0.0;
  for (std::size_t k = 0; k <= last(); ++k) {
    narrow += HenyeyGreenstein{narrow_}.evaluate(middles_[k].dot(direction)) / guesses_;
  }
  const double wide = HenyeyGreenstein{wide_}.evaluate(middles_[last()].dot(direction));
  return (narrow + kWideShare * (wide - narrow)) / kFourPi;
}

}  // namespace lamina
