// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/lit_tally.hpp"

#include <numbers>

#include "phase/henyey_greenstein.hpp"

namespace lamina {

namespace {

using std::numbers::pi;

/// A direction drawn within the disc of a lamp, uniform in solid angle.
Ray towards_disc(const DistantLight& light, Rng& rng) {
  if (light.cosine == 1.0) {
    return light.towards;
  }
  return scattered(light.towards, 1.0 - rng.uniform() * (1.0 - light.cosine), rng);
}

/// The radiance of a lamp times the solid angle of its disc.
double strength(const DistantLight& light) { return 2.0 / (1.0 + light.cosine); }

}  // namespace

void LitSums::add(const LitSums& other) {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      sums[k][c] += other.sums[k][c];
      squares[k][c] += other.squares[k][c];
    }
  }
}

void LitTally::escapes(const Ray& direction, const Weights& weights) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    found_.back()[c] += weights[c];
  }
  if (walk_.boundary().kind() != SurfaceBoundary::Kind::kSmooth) {
    return;
  }
  for (std::size_t k = 0; k < lights_.size(); ++k) {
    const double cosine = lights_[k].cosine;
    if (direction.dot(lights_[k].towards) >= cosine) {
      for (std::size_t c = 0; c < kChannels; ++c) {
        found_[k][c] += weights[c] / (pi * (1.0 - cosine * cosine));
      }
    }
  }
}

void LitTally::scatters(const Place& place, const Ray& direction, const CoefficientGrid::Sample& sample,
                        const Weights& weights, Rng& rng) {
  if (walk_.boundary().kind() != SurfaceBoundary::Kind::kMatched) {
    return;
  }
  for (std::size_t k = 0; k < lights_.size(); ++k) {
    const Ray towards = towards_disc(lights_[k], rng);
    const Weights passed = walk_.transmittance(place, towards, rng, counts_);
    const double cosine = direction.dot(towards);
    const double first = HenyeyGreenstein{sample.g_first}.evaluate(cosine);
    const bool same = sample.g_first == sample.g_second;
    const double second = same ? first : HenyeyGreenstein{sample.g_second}.evaluate(cosine);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const double phase = same ? first : first + static_cast<double>(sample.second[c]) * (second - first);
      found_[k][c] += weights[c] * passed[c] * phase * strength(lights_[k]) / (4.0 * pi);
    }
  }
}

void LitTally::meets_facets(const Place& place, const Ray& direction, const Ray& normal, const Weights& weights) {
  for (std::size_t k = 0; k < lights_.size(); ++k) {
    const Ray& towards = lights_[k].towards;
    const double share = walk_.boundary().leaving(direction, towards, normal);
    if (share > 0.0 && walk_.is_visible(place, towards)) {
      for (std::size_t c = 0; c < kChannels; ++c) {
        found_[k][c] += weights[c] * share;
      }
    }
  }
}

void LitTally::finish() {
  for (std::size_t k = 0; k < found_.size(); ++k) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      const double light = found_[k][c] / kChannels;
      sums_.sums[k][c] += light;
      sums_.squares[k][c] += light * light;
    }
    found_[k].fill(0.0);
  }
}

}  // namespace lamina
