// SPDX-License-Identifier: GPL-3.0-or-later
// Tallies the light of lamps and of the surroundings that leaves a solid.
#pragma once
#include <optional>
#include <vector>

#include "mesh_walk/aimed_light.hpp"
#include "mesh_walk/lamp.hpp"
#include "mesh_walk/light_moments.hpp"
#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// Sums over samples of the radiance that leaves at the start, and of its squares: one entry per lamp, and a last entry
/// for the surroundings. A sample's radiance is the mean over its paths.
struct LitSums {
  std::vector<LightMoments> sums;
  std::vector<LightMoments> squares;

  explicit LitSums(std::size_t lamps) : sums(lamps + 1), squares(lamps + 1) {}
  void add(const LitSums& other);
};

/// Collects light along walks. The estimator for lamps depends on the boundary:
///   matched: next-event estimation, a ray to the lamp from each scattering;
///   rough: at each meeting with the boundary the share that goes to the lamp; smooth: the light that is refracted or
///   reflected into the lamp, whose size must not be 0. In both cases also a ray from each scattering in the direction
///   of an AimedLight.
/// Paths that escape count the surroundings. Light that leaves and meets the solid again is followed. At an occluder,
/// a ray goes to each lamp that lights the occluder; what occluders emit counts as light of the surroundings.
class LitTally final : public WalkListener {
 public:
  /// `by_occluders`: of the light of lamps, only that which meets an occluder first.
  LitTally(const MeshWalk& walk, const std::vector<Lamp>& lamps, bool by_occluders, const Surroundings& surroundings,
           LitSums& sums, WalkCounts& counts)
      : walk_(walk),
        lamps_(lamps),
        by_occluders_(by_occluders),
        surroundings_(surroundings),
        sums_(sums),
        counts_(counts),
        found_(lamps.size() + 1),
        aims_(lamps.size()) {}

  bool leaves(const Meeting&) override { return true; }
  void escapes(const Ray& direction, const Weights& weights) override;
  void scatters(const Scattering& scattering, Rng& rng) override;
  void meets_emission(const Weights& radiance, const Weights& weights) override;
  void meets_occluder(const Occluders::Hit& hit, const Weights& weights, Rng& rng) override;
  void meets_boundary(const Meeting& meeting, Rng& rng) override;

  void starts(const Ray& view) override {
    last_.reset();
    view_ = view;
  }
  /// Ends a sample.
  void finish();

 private:
  /// The aim at a lamp of the last scattering, and the point of the lamp.
  struct Aim {
    std::optional<LampPoint> point;
    std::optional<AimedLight> light;
  };

  void add(std::size_t source, const Weights& weights, double factor);
  /// The radiance along -`direction`, inside, that enters from a lamp at this place of the surface.
  double entering(const Lamp& lamp, const LampPoint& point, const Place& place, const Ray& direction,
                  const Ray& normal);
  void collect_through_matched(const Scattering& scattering, Rng& rng);

  const MeshWalk& walk_;
  const std::vector<Lamp>& lamps_;
  bool by_occluders_;
  const Surroundings& surroundings_;
  LitSums& sums_;
  WalkCounts& counts_;
  std::vector<LightMoments> found_;  ///< light collected by the current sample
  Ray view_{};                       ///< the current path's direction to the eye
  std::vector<Aim> aims_;
  std::optional<Scattering> last_;  ///< the last event of the path, if it is a scattering
};

}  // namespace lamina
