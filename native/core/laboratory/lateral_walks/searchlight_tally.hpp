// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of scores, and of their products, over the samples of a walk.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "lateral_walks/lateral_walk.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// Scores of the light that leaves: its flux within radii (mm, ascending) and its transform E[weight J0(q r)] at
/// lateral frequencies q (1/mm).
struct SearchlightScores {
  std::vector<double> radii;
  std::vector<double> frequencies;
};

/// Sums over samples for each side (above, below). Tallies of several runs can be added and give estimates with errors.
struct SearchlightTally {
  struct Side {
    /// Sums by radial bin. Cumulative sums up to a radius are the sums of the flux within it and of its square.
    std::vector<double> within;
    std::vector<double> within_squares;
    /// Sums of v = (weight, weight r, weight r^2, weight J0(q r) for each q), and of the products v_i v_j, i <= j, by
    /// rows.
    std::vector<double> moments;
    std::vector<double> products;
  };
  std::array<Side, 2> sides;
  std::uint64_t count = 0;
  std::uint64_t events = 0;

  explicit SearchlightTally(const SearchlightScores& scores);
  void add(const SearchlightTally& other);
  void add_sample(const SearchlightScores& scores, const Leaving& leaving);
};

/// Runs blocks [first, last) of a walk. The result does not depend on the number of threads.
SearchlightTally run_lateral_walk(const LateralWalk& walk, const SearchlightScores& scores, std::uint64_t seed,
                                  std::uint64_t first_block, std::uint64_t last_block, ThreadPool& pool);

}  // namespace lamina
