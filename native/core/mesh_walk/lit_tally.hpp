// SPDX-License-Identifier: GPL-3.0-or-later
// Tallies the light of distant lamps and of a uniform sky that leaves a solid.
#pragma once
#include <vector>

#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// A lamp at infinity: a disc that gives irradiance 1 on a plane perpendicular to its direction.
struct DistantLight {
  Ray towards;          ///< unit vector to the lamp
  double cosine = 1.0;  ///< cosine of the disc's angular radius; 1: all light comes from one direction
};

/// Sums over samples of the radiance that leaves at the start, and of the squared radiance: one entry per lamp, and a
/// last entry for a sky of radiance 1. A sample's radiance is the mean over its paths.
struct LitSums {
  std::vector<Weights> sums;
  std::vector<Weights> squares;

  explicit LitSums(std::size_t lights) : sums(lights + 1), squares(lights + 1) {}
  void add(const LitSums& other);
};

/// Collects light along walks. The estimator for lamps depends on the boundary:
///   matched: next-event estimation, a ray to the lamp from each scattering;
///   rough: the refraction towards the lamp, at each interaction with the boundary from inside;
///   smooth: only paths that escape into the lamp's disc count, so the disc must have a positive angular radius.
/// Paths that escape also count the sky. Light that leaves and meets the solid again is followed.
class LitTally final : public WalkListener {
 public:
  LitTally(const MeshWalk& walk, const std::vector<DistantLight>& lights, LitSums& sums, WalkCounts& counts)
      : walk_(walk), lights_(lights), sums_(sums), counts_(counts), found_(lights.size() + 1) {}

  bool leaves(const Exit&) override { return true; }
  void escapes(const Ray& direction, const Weights& weights) override;
  void scatters(const Place& place, const Ray& direction, const CoefficientGrid::Sample& sample, const Weights& weights,
                Rng& rng) override;
  void meets_facets(const Place& place, const Ray& direction, const Ray& normal, const Weights& weights) override;

  /// Ends a sample.
  void finish();

 private:
  const MeshWalk& walk_;
  const std::vector<DistantLight>& lights_;
  LitSums& sums_;
  WalkCounts& counts_;
  std::vector<Weights> found_;  ///< light collected by the current sample
};

}  // namespace lamina
