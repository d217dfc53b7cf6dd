// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/lit_tally.hpp"

#include <algorithm>
#include <numbers>

namespace lamina {

void LitSums::add(const LitSums& other) {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    for (std::size_t i = 0; i < sums[k].size(); ++i) {
      sums[k][i] += other.sums[k][i];
      squares[k][i] += other.squares[k][i];
    }
  }
}

void LitTally::escapes(const Ray& direction, const Weights& weights) {
  meets_emission(surroundings_.along(direction), weights);
}

void LitTally::scatters(const Scattering& scattering, Rng& rng) {
  if (lamps_.empty() || by_occluders_) {
    return;
  }
  if (walk_.boundary().kind() == SurfaceBoundary::Kind::kMatched) {
    collect_through_matched(scattering, rng);
    return;
  }
  last_ = scattering;
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    Aim& aim = aims_[k];
    aim.point.emplace(rng);
    aim.light = AimedLight::at(scattering, lamps_[k], *aim.point, walk_, counts_);
    if (!aim.light) {
      continue;
    }
    const Ray direction = aim.light->sample(rng);
    const auto emergence = walk_.emergence(scattering.place, direction, scattering.shells, rng, counts_);
    if (!emergence) {
      continue;
    }
    const double radiance = entering(lamps_[k], *aim.point, emergence->place, direction, emergence->normal);
    if (radiance == 0.0) {
      continue;
    }
    const Weights phases = scattering.phases(scattering.before.dot(direction));
    // Balance heuristic: divided by the sum of the densities of both ways to draw this direction.
    const double densities = aim.light->density(direction) + phases[scattering.leader];
    Weights weights = scattering.weights;
    for (std::size_t c = 0; c < kChannels; ++c) {
      weights[c] *= phases[c] * emergence->passed[c];
    }
    add(k, weights, radiance / densities);
  }
}

void LitTally::meets_emission(const Weights& radiance, const Weights& weights) {
  Weights light = weights;
  for (std::size_t c = 0; c < kChannels; ++c) {
    light[c] *= radiance[c];
  }
  add(lamps_.size(), light, 1.0);
}

void LitTally::meets_occluder(const Occluders::Hit& hit, const Weights& arriving, Rng& rng) {
  Weights weights = arriving;
  for (std::size_t c = 0; c < kChannels; ++c) {
    weights[c] *= static_cast<double>(hit.face.albedo[c]);
  }
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    if (!Occluders::holds(hit.lit, lamps_[k].linking())) {
      continue;
    }
    const LampLight light = lamps_[k].light(hit.place, LampPoint(rng));
    const double flux = light.irradiance * std::max(0.0, light.towards.dot(hit.normal));
    if (flux == 0.0) {
      continue;
    }
    // Light that has passed the solid is not light that meets an occluder first.
    Weights seen =
        walk_.arriving(hit.place, light.towards, light.distance, !by_occluders_, lamps_[k].linking(), rng, counts_);
    for (std::size_t c = 0; c < kChannels; ++c) {
      seen[c] *= weights[c];
    }
    add(k, seen, flux / std::numbers::pi);
  }
}

void LitTally::meets_boundary(const Meeting& meeting, Rng& rng) {
  if (by_occluders_) {
    return;
  }
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    double share = 1.0;
    LampPoint point = last_ ? *aims_[k].point : LampPoint(rng);
    if (last_ && aims_[k].light) {
      const double phase = last_->phases(last_->before.dot(meeting.direction))[last_->leader];
      share = phase / (phase + aims_[k].light->density(meeting.direction));
    }
    const double radiance = entering(lamps_[k], point, meeting.place, meeting.direction, meeting.normal);
    if (radiance > 0.0) {
      add(k, meeting.weights, share * radiance);
    }
  }
  last_.reset();
}

void LitTally::finish() {
  for (std::size_t k = 0; k < found_.size(); ++k) {
    for (std::size_t i = 0; i < found_[k].size(); ++i) {
      const double light = found_[k][i] / kChannels;
      sums_.sums[k][i] += light;
      sums_.squares[k][i] += light * light;
    }
    found_[k].fill(0.0);
  }
}

void LitTally::add(std::size_t source, const Weights& weights, double factor) {
  lamina::add(found_[source], weights, factor, view_);
}

double LitTally::entering(const Lamp& lamp, const LampPoint& point, const Place& place, const Ray& direction,
                          const Ray& normal) {
  double radiance = 0.0;
  Ray towards;
  double distance = 0.0;
  if (walk_.boundary().kind() == SurfaceBoundary::Kind::kRough) {
    const LampLight light = lamp.light(place, point);
    towards = light.towards;
    distance = light.distance;
    radiance = light.irradiance > 0.0 ? light.irradiance * walk_.boundary().leaving(direction, towards, normal) : 0.0;
  } else {
    const SurfaceBoundary::Outcome outcome = walk_.boundary().leaving(direction, normal);
    const auto seen = outcome.weight > 0.0 ? lamp.seen(place, outcome.direction) : std::nullopt;
    if (seen) {
      towards = outcome.direction;
      distance = seen->distance;
      radiance = outcome.weight * seen->radiance;
    }
  }
  if (radiance > 0.0) {
    ++counts_.rays;
  }
  return radiance > 0.0 && walk_.is_visible(place, towards, distance, lamp.linking()) ? radiance : 0.0;
}

void LitTally::collect_through_matched(const Scattering& scattering, Rng& rng) {
  for (std::size_t k = 0; k < lamps_.size(); ++k) {
    const LampLight light = lamps_[k].light(scattering.place, LampPoint(rng));
    if (light.irradiance == 0.0) {
      continue;
    }
    Weights weights = walk_.transmittance(scattering.place, light.towards, light.distance, scattering.shells,
                                          lamps_[k].linking(), rng, counts_);
    const Weights phases = scattering.phases(scattering.before.dot(light.towards));
    for (std::size_t c = 0; c < kChannels; ++c) {
      weights[c] *= scattering.weights[c] * phases[c];
    }
    add(k, weights, light.irradiance);
  }
}

}  // namespace lamina
