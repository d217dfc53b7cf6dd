// SPDX-License-Identifier: GPL-3.0-or-later
// The light of distant lamps and of a uniform sky that leaves a solid.
#pragma once
#include <vector>

#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// A lamp at infinity, a disc of the irradiance 1 on a plane across its direction.
struct DistantLight {
  Ray towards;          ///< the lamp, of length 1
  double cosine = 1.0;  ///< of the disc's angular radius; 1: all light comes from one direction
};

/// Sums over walks of the radiance that leaves the start of each, and of its square, from each lamp, and last from a
/// sky of radiance 1.
struct LitSums {
  std::vector<Weights> sums;
  std::vector<Weights> squares;

  explicit LitSums(std::size_t lights) : sums(lights + 1), squares(lights + 1) {}
  void add(const LitSums& other);
};

/// Collects light along walks. Lamps are met
///   through a matched boundary: from each scattering, by a ray to the lamp (next-event estimation);
///   through a rough one: from each meeting with the boundary from inside, by its refraction towards the lamp;
///   through a smooth one: where light happens to escape into the disc of the lamp, which so must have an extent.
/// The sky is met by what escapes. Light that leaves and meets the solid again is followed.
class LitTally final : public WalkListener {
 public:
  LitTally(const MeshWalk& walk, const std::vector<DistantLight>& lights, LitSums& sums, WalkCounts& counts)
      : walk_(walk), lights_(lights), sums_(sums), counts_(counts), found_(lights.size() + 1) {}

  bool leaves(const Exit&) override { return true; }
  void escapes(const Ray& direction, const Weights& weights) override;
  void scatters(const Place& place, const Ray& direction, const CoefficientGrid::Sample& sample, const Weights& weights,
                Rng& rng) override;
  void meets_facets(const Place& place, const Ray& direction, const Ray& normal, const Weights& weights) override;

  /// Ends a walk.
  void finish();

 private:
  const MeshWalk& walk_;
  const std::vector<DistantLight>& lights_;
  LitSums& sums_;
  WalkCounts& counts_;
  std::vector<Weights> found_;  ///< by this walk
};

}  // namespace lamina
