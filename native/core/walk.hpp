// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rng.hpp"
#include "thread_pool.hpp"
#include "walk_blocks.hpp"

namespace lamina {

/// An estimator by random walk of one number: a BRDF value, an albedo.
class Walk {
 public:
  Walk() = default;
  Walk(const Walk&) = delete;
  Walk& operator=(const Walk&) = delete;
  virtual ~Walk() = default;

  /// One sample; its expectation is the number. Counts its scattering events in `events`. Called from many
  /// threads at once.
  virtual double sample(Rng& rng, std::uint64_t& events) const = 0;
};

/// Sums over samples, from which estimates of any parts of a run can be merged.
struct Tally {
  double sum = 0.0;
  double squares = 0.0;
  double largest = 0.0;  ///< the largest sample's size: a few that dominate show a variance not to be trusted
  std::uint64_t count = 0;
  std::uint64_t events = 0;

  double mean() const;
  double standard_error() const;
  void add_sample(double value) {
    sum += value;
    squares += value * value;
    largest = std::max(largest, std::abs(value));
    ++count;
  }
  void add(const Tally& other);
};

/// Blocks [first, last) of a walk with this seed: the same bytes for any number of threads.
Tally run_walk(const Walk& walk, std::uint64_t seed, std::uint64_t first_block, std::uint64_t last_block,
               ThreadPool& pool);

}  // namespace lamina
