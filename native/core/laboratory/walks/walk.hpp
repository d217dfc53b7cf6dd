// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a walk: samples on threads, sums in a fixed order.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "numeric/rng.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// A random-walk estimator of one number, such as a BRDF value or an albedo.
class Walk {
 public:
  Walk() = default;
  Walk(const Walk&) = delete;
  Walk& operator=(const Walk&) = delete;
  virtual ~Walk() = default;

  /// One unbiased sample. Adds its scattering events to `events`. Thread-safe.
  virtual double sample(Rng& rng, std::uint64_t& events) const = 0;
};

/// Sums over samples. Tallies of the parts of a run can be added.
struct Tally {
  double sum = 0.0;
  double squares = 0.0;
  double largest = 0.0;  ///< largest absolute sample; if it dominates, the standard error is unreliable
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

/// Number of samples in a block, the unit of a run. Blocks are summed in order.
inline constexpr std::uint64_t kWalkBlock = 4096;

/// Runs blocks [first, last) of a walk. The result does not depend on the number of threads.
Tally run_walk(const Walk& walk, std::uint64_t seed, std::uint64_t first_block, std::uint64_t last_block,
               ThreadPool& pool);

}  // namespace lamina
