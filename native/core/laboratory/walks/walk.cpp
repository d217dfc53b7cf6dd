// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "walks/walk_blocks.hpp"

namespace lamina {

double Tally::mean() const { return count > 0 ? sum / static_cast<double>(count) : 0.0; }

double Tally::standard_error() const {
  if (count < 2) {
    return std::numeric_limits<double>::infinity();
  }
  const double n = static_cast<double>(count);
  const double variance = std::max(0.0, squares / n - mean() * mean()) * n / (n - 1.0);
  return std::sqrt(variance / n);
}

void Tally::add(const Tally& other) {
  sum += other.sum;
  squares += other.squares;
  largest = std::max(largest, other.largest);
  count += other.count;
  events += other.events;
}

Tally run_walk(const Walk& walk, std::uint64_t seed, std::uint64_t first_block, std::uint64_t last_block,
               ThreadPool& pool) {
  return sum_of_blocks(Tally(), seed, first_block, last_block, pool,
                       [&](Rng& rng, Tally& tally) { tally.add_sample(walk.sample(rng, tally.events)); });
}

}  // namespace lamina
