// SPDX-License-Identifier: GPL-3.0-or-later
// A random walk inside a solid, backwards from where light leaves it.
#pragma once
#include <cstdint>
#include <optional>

#include "interior/brick_flight.hpp"
#include "interior/coefficient_grid.hpp"
#include "mesh_walk/solid.hpp"
#include "mesh_walk/surface_boundary.hpp"

namespace lamina {

/// An exit of a walk. By reciprocity, light that enters here against `direction` contributes with these weights to the
/// light that leaves at the start of the walk.
struct Exit {
  Place place;
  Ray normal;
  Ray direction;  ///< of travel, outwards
  Weights weights;
};

/// Interface for listeners to the events of a walk.
class WalkListener {
 public:
  WalkListener() = default;
  WalkListener(const WalkListener&) = delete;
  WalkListener& operator=(const WalkListener&) = delete;
  virtual ~WalkListener() = default;

  /// Light leaves the solid. Returns true to follow the light outside until it meets the solid again.
  virtual bool leaves(const Exit& exit) = 0;
  /// Light that was followed outside does not meet the solid again.
  virtual void escapes(const Ray&, const Weights&) {}
  /// Light is scattered. Arguments: position, direction of travel before the scattering, coefficients, and the weights
  /// after absorption.
  virtual void scatters(const Place&, const Ray&, const CoefficientGrid::Sample&, const Weights&, Rng&) {}
  /// Light from inside meets a rough boundary. Arguments: position, direction of travel, outward normal, weights.
  virtual void meets_facets(const Place&, const Ray&, const Ray&, const Weights&) {}
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
/// paths. Absorption reduces the weights; Russian roulette ends paths. The path length is unlimited.
class MeshWalk {
 public:
  MeshWalk(const Solid& solid, const CoefficientGrid& grid, const SurfaceBoundary& boundary)
      : solid_(solid), grid_(grid), boundary_(boundary) {}

  /// The start of a walk: a position on or very near the surface, and a unit normal. The normal may differ from the
  /// face's normal, like a shading normal; it is used for the boundary at the start only.
  struct Start {
    Place place;
    Ray normal;
    std::optional<Ray> view;  ///< direction to the eye; if not given, cosine-distributed about the normal
  };
  /// One sample. The results are the means over its three paths.
  void run(const Start& start, Rng& rng, WalkListener& listener, WalkCounts& counts) const;

  /// Unbiased estimate per channel, by ratio tracking (Novak et al. 2014), of the transmittance from a position inside
  /// the solid along a direction to infinity. The ray may leave and enter the solid again. For a matched boundary.
  Weights transmittance(const Place& from, const Ray& direction, Rng& rng, WalkCounts& counts) const;

  const SurfaceBoundary& boundary() const { return boundary_; }
  bool is_visible(const Place& from, const Ray& direction) const;

 private:
  class Path;

  const Solid& solid_;
  const CoefficientGrid& grid_;
  const SurfaceBoundary& boundary_;
};

}  // namespace lamina
