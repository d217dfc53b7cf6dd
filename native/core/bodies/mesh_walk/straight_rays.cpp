// SPDX-License-Identifier: GPL-3.0-or-later
// The straight rays of MeshWalk: light that is not scattered on its way.
#include <cmath>
#include <limits>

#include "events/survival.hpp"
#include "mesh_walk/mesh_walk.hpp"
#include "mesh_walk/surface_search.hpp"

namespace lamina {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

/// Continues a flight from `from` to the distance `end`, and multiplies `shares` by the transmittance. False if no
/// light is left.
bool MeshWalk::pass(BrickFlight& flight, const Place& from, const Ray& direction, double end, Rng& rng,
                    Weights& shares) const {
  for (;;) {
    const double at = flight.advance(-std::log(rng.uniform()), end);
    if (at == kInfinity) {
      return true;
    }
    const CoefficientGrid::Sample sample = grid_.at(from.moved(direction, at), rng);
    for (std::size_t c = 0; c < kChannels; ++c) {
      shares[c] *= 1.0 - static_cast<double>(sample.extinction[c]) / flight.majorant();
    }
    const double before = mean_of(shares);
    double after = before;
    if (!survives(after, rng)) {
      return false;
    }
    for (double& share : shares) {
      share *= after / before;
    }
  }
}

Weights MeshWalk::transmittance(const Place& from, const Ray& direction, double farthest, int shells, unsigned linking,
                                Rng& rng, WalkCounts& counts) const {
  Weights shares = {1.0, 1.0, 1.0};
  BrickFlight flight(grid_, from, direction, kChannels);
  SurfaceSearch surface(solid_, from, direction, shells, false);
  for (;;) {
    ++counts.rays;
    const auto out = surface.leaving(farthest);
    const double end = out ? out->distance : farthest;
    if (end < kInfinity && !pass(flight, from, direction, end, rng, shares)) {
      return {};
    }
    if (!out) {
      return shares;
    }
    if (out->is_opaque) {
      return {};
    }
    ++counts.rays;
    const auto in = surface.entering(farthest);
    const Place outside = from.moved(direction, out->distance);
    if (occluders_ != nullptr &&
        occluders_->block(outside, direction, (in ? in->distance : farthest) - out->distance, linking)) {
      return {};
    }
    if (!in) {
      return shares;
    }
    if (in->is_opaque) {
      return {};
    }
    flight.skip_to(in->distance);
  }
}

std::optional<Emergence> MeshWalk::emergence(const Place& from, const Ray& direction, int shells, Rng& rng,
                                             WalkCounts& counts) const {
  ++counts.rays;
  const auto out = SurfaceSearch(solid_, from, direction, shells, false).leaving(kInfinity);
  if (!out || out->is_opaque) {
    return std::nullopt;
  }
  Weights shares = {1.0, 1.0, 1.0};
  BrickFlight flight(grid_, from, direction, kChannels);
  if (!pass(flight, from, direction, out->distance, rng, shares)) {
    return std::nullopt;
  }
  return Emergence{from.moved(direction, out->distance), out->normal, shares};
}

std::optional<Ray> MeshWalk::normal_towards(const Place& from, const Ray& direction, double farthest,
                                            int shells) const {
  const auto out = SurfaceSearch(solid_, from, direction, shells, false).leaving(farthest);
  return out && !out->is_opaque ? std::optional(out->normal) : std::nullopt;
}

Weights MeshWalk::arriving(const Place& from, const Ray& direction, double farthest, bool through, unsigned linking,
                           Rng& rng, WalkCounts& counts) const {
  ++counts.rays;
  const auto in = SurfaceSearch(solid_, from, direction, 1, true).entering(farthest);
  if (occluders_ != nullptr && occluders_->block(from, direction, in ? in->distance : farthest, linking)) {
    return {};
  }
  if (!in) {
    return {1.0, 1.0, 1.0};
  }
  if (!through || in->is_opaque || boundary_.kind() != SurfaceBoundary::Kind::kMatched) {
    return {};
  }
  return transmittance(from.moved(direction, in->distance), direction, farthest - in->distance, 1, linking, rng,
                       counts);
}

bool MeshWalk::is_visible(const Place& from, const Ray& direction, double farthest, unsigned linking) const {
  return !SurfaceSearch(solid_, from, direction, 1, true).entering(farthest) &&
         (occluders_ == nullptr || !occluders_->block(from, direction, farthest, linking));
}

}  // namespace lamina
