// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/point_walks.hpp"

#include <utility>

namespace lamina {

namespace {

// Number of samples in a piece of work for one thread. The sums of pieces are added in order, for reproducible results.
constexpr std::uint64_t kPiece = 256;

/// For each point, the sum of the results that `run(start, rngs of a piece)` gives for all pieces.
template <typename Result, typename Run>
std::vector<Result> sum_by_point(const WalkPoints& points, const Result& empty, ThreadPool& pool, const Run& run) {
  const std::uint64_t pieces = (points.walks + kPiece - 1) / kPiece;
  std::vector<Result> parts(points.starts.size() * pieces, empty);
  pool.run(parts.size(), [&](std::size_t task) {
    const std::uint64_t point = task / pieces;
    const std::uint64_t first = task % pieces * kPiece;
    Result part = empty;
    run(points.starts[point], part, [&](const auto& walk_once) {
      for (std::uint64_t walk = first; walk < std::min(points.walks, first + kPiece); ++walk) {
        Rng rng(points.seed, ((points.first_number + point) << 32U) + points.first_walk + walk);
        walk_once(rng);
      }
    });
    parts[task] = std::move(part);
  });
  std::vector<Result> sums(points.starts.size(), empty);
  for (std::size_t task = 0; task < parts.size(); ++task) {
    sums[task / pieces].add(parts[task]);
  }
  return sums;
}

}  // namespace

void ExitResult::add(const ExitResult& other) {
  exits.add(other.exits);
  counts.add(other.counts);
}

void LitResult::add(const LitResult& other) {
  light.add(other.light);
  counts.add(other.counts);
}

std::vector<ExitResult> walk_to_exits(const MeshWalk& walk, const WalkPoints& points, ThreadPool& pool,
                                      const LateAfter& late_after) {
  const auto run = [&](const MeshWalk::Start& start, ExitResult& result, const auto& each) {
    ExitTally tally(result.exits, late_after);
    tally.begin(start.place);
    each([&](Rng& rng) {
      walk.run(start, rng, tally, result.counts);
      tally.finish();
    });
  };
  return sum_by_point(points, ExitResult{}, pool, run);
}

std::vector<LitResult> walk_to_lights(const MeshWalk& walk, const WalkPoints& points, const std::vector<Lamp>& lamps,
                                      bool by_occluders, const Surroundings& surroundings, ThreadPool& pool) {
  const auto run = [&](const MeshWalk::Start& start, LitResult& result, const auto& each) {
    LitTally tally(walk, lamps, by_occluders, surroundings, result.light, result.counts);
    each([&](Rng& rng) {
      walk.run(start, rng, tally, result.counts);
      tally.finish();
    });
  };
  return sum_by_point(points, LitResult{LitSums(lamps.size()), {}}, pool, run);
}

}  // namespace lamina
