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

/// Light that leaves a solid. By reciprocity it is light that enters there, against the direction, and contributes with
/// these weights to what leaves at the start of the walk.
struct Exit {
  Place place;
  Ray normal;
  Ray direction;  ///< of travel, outwards
  Weights weights;
};

/// What is told of the events of a walk.
class WalkListener {
 public:
  WalkListener() = default;
  WalkListener(const WalkListener&) = delete;
  WalkListener& operator=(const WalkListener&) = delete;
  virtual ~WalkListener() = default;

  /// Light leaves the solid. Returns whether it shall be followed outside, until it meets the solid again.
  virtual bool leaves(const Exit& exit) = 0;
  /// Light that left and was followed meets nothing more.
  virtual void escapes(const Ray&, const Weights&) {}
  /// Light that travels along `direction` is scattered; the weights hold the loss by absorption.
  virtual void scatters(const Place&, const Ray&, const CoefficientGrid::Sample&, const Weights&, Rng&) {}
  /// Light from inside meets a rough boundary.
  virtual void meets_facets(const Place&, const Ray&, const Ray&, const Weights&) {}
};

/// Sums over walks, beside those of listeners.
struct WalkCounts {
  double mirrored = 0.0;  ///< weight that the boundary reflects at the start
  double lost = 0.0;      ///< weight that misses the surface by rounding
  std::uint64_t scatterings = 0;
  std::uint64_t collisions = 0;  ///< scatterings, and those rejected
  std::uint64_t rays = 0;

  void add(const WalkCounts& other);
};

/// Delta tracking: tentative collisions with the majorant of each brick, accepted by the extinction (Woodcock et al.
/// 1965). One path serves red, green and blue: a collision is accepted by the mean of the channels' extinctions,
/// weighted by the weights of the path so far (Kutz et al. 2017, history-aware averages). The density of a path is then
/// the mean of its densities in the three channels: the balance heuristic over channels, so that no weight exceeds
/// three times the mean. Absorption by weights, ended by Russian roulette; no limit on the length of paths.
class MeshWalk {
 public:
  MeshWalk(const Solid& solid, const CoefficientGrid& grid, const SurfaceBoundary& boundary)
      : solid_(solid), grid_(grid), boundary_(boundary) {}

  /// Where walks start: a place on or very near the surface, and its normal, of length 1. The normal need not be that
  /// of the face: the boundary is met with it at the start, as shading has it.
  struct Start {
    Place place;
    Ray normal;
    std::optional<Ray> view;  ///< towards the eye; without: cosine-distributed about the normal
  };
  void run(const Start& start, Rng& rng, WalkListener& listener, WalkCounts& counts) const;

  /// The share of light in each channel that passes from a place inside the solid along a direction to infinity, in and
  /// out of the solid, an unbiased estimate by ratio tracking (Novak et al. 2014). For a matched boundary.
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
