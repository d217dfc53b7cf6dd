// SPDX-License-Identifier: GPL-3.0-or-later
// Multithreaded walks from many points of a surface.
#pragma once
#include <vector>

#include "mesh_walk/exit_tally.hpp"
#include "mesh_walk/lit_tally.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// Points on the surface of a solid, and the samples of each point; see MeshWalk for the walks of a sample. Random
/// numbers depend on the seed, the number of the point and the number of the sample.
struct WalkPoints {
  std::vector<MeshWalk::Start> starts;
  std::uint64_t first_number = 0;
  std::uint64_t first_walk = 0;
  std::uint64_t walks = 1;  ///< samples per point; the number of the last sample is at most 2^32
  std::uint64_t seed = 0;
};

/// Sums over the samples of one point.
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

/// Tallies the first exit of each path, by point. Results are identical bytes for any number of threads.
std::vector<ExitResult> walk_to_exits(const MeshWalk& walk, const WalkPoints& points, ThreadPool& pool,
                                      const LateAfter& late_after = {kNever, kNever, kNever});

/// Estimates the radiance that leaves at each point under lamps and the surroundings. `by_occluders`: see LitTally.
std::vector<LitResult> walk_to_lights(const MeshWalk& walk, const WalkPoints& points, const std::vector<Lamp>& lamps,
                                      bool by_occluders, const Surroundings& surroundings, ThreadPool& pool);

}  // namespace lamina
