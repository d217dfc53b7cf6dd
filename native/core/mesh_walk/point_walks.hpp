// SPDX-License-Identifier: GPL-3.0-or-later
// Walks from many points of a surface, on threads.
#pragma once
#include <vector>

#include "mesh_walk/exit_tally.hpp"
#include "mesh_walk/lit_tally.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// Points on the surface of a solid. A point's random numbers depend on the seed, its number and the walk's.
struct WalkPoints {
  std::vector<MeshWalk::Start> starts;
  std::uint64_t first_number = 0;
  std::uint64_t walks = 1;  ///< from each, at most 2^32
  std::uint64_t seed = 0;
};

/// Sums over the walks of one point.
struct ExitResult {
  ExitSums exits;
  WalkCounts counts;

  void add(const ExitResult& other);
};
struct LitResult {
  LitSums light;
  WalkCounts counts;

  void add(const LitResult& other);
};

/// For each point, what leaves first: the same bytes for any number of threads.
std::vector<ExitResult> walk_to_exits(const MeshWalk& walk, const WalkPoints& points, ThreadPool& pool);

/// For each point, the radiance that leaves by the light of lamps and of a sky.
std::vector<LitResult> walk_to_lights(const MeshWalk& walk, const WalkPoints& points,
                                      const std::vector<DistantLight>& lights, ThreadPool& pool);

}  // namespace lamina
