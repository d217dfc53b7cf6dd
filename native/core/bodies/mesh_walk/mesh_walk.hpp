// SPDX-License-Identifier: GPL-3.0-or-later
// A random walk inside a solid, backwards from where light leaves it.
#pragma once
#include <cstdint>
#include <optional>

#include "interior/brick_flight.hpp"
#include "interior/coefficient_grid.hpp"
#include "mesh_walk/occluders.hpp"
#include "mesh_walk/solid.hpp"
#include "mesh_walk/surface_boundary.hpp"

namespace lamina {

class WeightWindows;

/// Light at the surface. By reciprocity, light that enters where a walk leaves, against its direction, contributes with
/// these weights to the light that leaves at the start of the walk.
struct Meeting {
  Place place;
  Ray normal;  ///< outward, of the face
  std::uint32_t face;
  Ray direction;  ///< of travel
  Weights weights;
  std::uint64_t scatterings;  ///< of the path so far
};

/// A scattering of light inside.
struct Scattering {
  Place place;
  Ray before;                      ///< direction of travel before the scattering
  CoefficientGrid::Sample sample;  ///< coefficients
  Weights weights;                 ///< after absorption
  std::size_t leader;              ///< channel from whose phase function the next direction is drawn
  Ray normal;                      ///< of the face that the path met last
  int shells;                      ///< number of parts of the mesh that contain the position

  /// The phase function of each channel, normalised to 1 over the sphere.
  Weights phases(double cosine) const;
};

/// Light that reaches the surface from inside: where, the outward normal, and the transmittance by channel.
struct Emergence {
  Place place;
  Ray normal;
  Weights passed;
};

/// Interface for listeners to the events of a walk.
class WalkListener {
 public:
  WalkListener() = default;
  WalkListener(const WalkListener&) = delete;
  WalkListener& operator=(const WalkListener&) = delete;
  virtual ~WalkListener() = default;

  /// A path starts at a point of the surface, backwards from an eye in the direction `view`.
  virtual void starts(const Ray& /*view*/) {}
  /// Light leaves the solid. Returns true to follow the light outside until it meets the solid again.
  virtual bool leaves(const Meeting& exit) = 0;
  /// Light that was followed outside does not meet the solid again.
  virtual void escapes(const Ray&, const Weights&) {}
  virtual void scatters(const Scattering&, Rng&) {}
  /// Light that occluders emit meets light outside, which has these weights.
  virtual void meets_emission(const Weights&, const Weights&) {}
  /// Light outside meets an occluder.
  virtual void meets_occluder(const Occluders::Hit&, const Weights&, Rng&) {}
  /// Light meets a boundary, from inside or from outside.
  virtual void meets_boundary(const Meeting&, Rng&) {}
};

/// Sums over samples that do not depend on the listener. Weights are means over the paths of a sample.
struct WalkCounts {
  double mirrored = 0.0;  ///< weight that the boundary reflects at the start
  double lost = 0.0;      ///< weight of paths that miss the surface by rounding errors
  std::uint64_t scatterings = 0;
  std::uint64_t collisions = 0;  ///< scatterings and rejected collisions
  std::uint64_t rays = 0;

  void add(const WalkCounts& other);
};

/// Delta tracking: tentative collisions with the majorant of each brick, accepted with probability extinction /
/// majorant (Woodcock et al. 1965). A sample consists of three paths, one led by each channel. The leading channel
/// decides collisions and directions. In a grey grid each path serves all channels, with the balance heuristic over the
/// leaders (Wilkie et al. 2014). Otherwise each path serves its leader only: after many collisions a path is typical of
/// one channel, and the balance heuristic, with one leader or three, has two to twenty times the variance of separate
/// paths. Separate paths of a sample use the same random numbers: where the channels differ by a factor only, the paths
/// have the same shape, so that most of the noise is common to the channels and changes brightness, not colour.
/// Photons of a lamp always serve all channels: equal numbers would not bring them to the same place, and the light of
/// three leaders has .6 to 1.2 times the variance at equal time, and noise of colour like that of separate photons.
/// Absorption reduces the weights; Russian roulette ends paths. The path length is unlimited.
/// Opaque faces absorb all light that meets them.
/// Light outside that meets an occluder is reflected diffusely, and followed.
class MeshWalk {
 public:
  /// `occluders`: null for none.
  MeshWalk(const Solid& solid, const CoefficientGrid& grid, const SurfaceBoundary& boundary,
           const Occluders* occluders = nullptr)
      : solid_(solid), grid_(grid), boundary_(boundary), occluders_(occluders) {}

  /// The start of a walk: a position on or very near the surface, and a unit normal. The normal may differ from the
  /// face's normal, like a shading normal; it is used for the boundary at the start only.
  struct Start {
    Place place;
    Ray normal;
    std::optional<Ray> view;  ///< direction to the eye; if not given, cosine-distributed about the normal
  };
  /// One sample. The results are the means over its three paths.
  void run(const Start& start, Rng& rng, WalkListener& listener, WalkCounts& counts) const;

  /// Light of a lamp that meets the surface from outside, with the same weight in each channel.
  struct Photon {
    Place place;
    Ray normal;
    std::uint32_t face;
    Ray direction;  ///< of travel
    double weight;
  };
  /// The path of a photon, led by one channel. Weights are those of the light's power. `windows`: splits the photon in
  /// dark parts; null: nowhere.
  void shine(const Photon& photon, std::size_t leader, Rng& rng, WalkListener& listener, WalkCounts& counts,
             const WeightWindows* windows) const;

  /// Unbiased estimate per channel, by ratio tracking (Novak et al. 2014), of the transmittance from a position inside
  /// the solid along a direction up to the distance `farthest`. The ray may leave and enter the solid again. For a
  /// matched boundary. `shells`: see Scattering. `linking`: of the light, which not all occluders take.
  Weights transmittance(const Place& from, const Ray& direction, double farthest, int shells, unsigned linking,
                        Rng& rng, WalkCounts& counts) const;
  /// Where a ray from inside first leaves the solid, with the transmittance by ratio tracking; nothing if no light
  /// arrives there.
  std::optional<Emergence> emergence(const Place& from, const Ray& direction, int shells, Rng& rng,
                                     WalkCounts& counts) const;
  /// The normal where a ray from inside leaves the solid, within the distance `farthest`.
  std::optional<Ray> normal_towards(const Place& from, const Ray& direction, double farthest, int shells) const;

  /// A lower bound in mm of the distance from a position to the surface; 0 if no bound is known.
  double clearance(const Place& place) const { return solid_.clearance(place); }

  const SurfaceBoundary& boundary() const { return boundary_; }
  /// The share of light that reaches a position outside from the distance `farthest` without scattering. `through`:
  /// also through the solid, if its boundary is matched.
  Weights arriving(const Place& from, const Ray& direction, double farthest, bool through, unsigned linking, Rng& rng,
                   WalkCounts& counts) const;

  /// True if neither a part of the solid nor an occluder takes light of a linking between a position outside or on the
  /// surface and the distance `farthest`.
  bool is_visible(const Place& from, const Ray& direction, double farthest, unsigned linking) const;

 private:
  class Path;
  bool pass(BrickFlight& flight, const Place& from, const Ray& direction, double end, Rng& rng, Weights& shares) const;

  const Solid& solid_;
  const CoefficientGrid& grid_;
  const SurfaceBoundary& boundary_;
  const Occluders* occluders_;
};

}  // namespace lamina
