// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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
  // Threads share the work of a block in fixed pieces, summed in order, so that no thread waits long at the end.
  constexpr std::uint64_t kPiece = 512;
  static_assert(kWalkBlock % kPiece == 0);
  std::vector<Tally> pieces((last_block - first_block) * (kWalkBlock / kPiece));
  pool.run(pieces.size(), [&](std::size_t k) {
    Tally tally;
    const std::uint64_t first = first_block * kWalkBlock + k * kPiece;
    for (std::uint64_t sample = first; sample < first + kPiece; ++sample) {
      Rng rng(seed, sample);
      tally.add_sample(walk.sample(rng, tally.events));
    }
    pieces[k] = tally;
  });
  Tally total;
  for (std::size_t first = 0; first < pieces.size(); first += kWalkBlock / kPiece) {
    Tally block;
    for (std::size_t k = first; k < first + kWalkBlock / kPiece; ++k) {
      block.add(pieces[k]);
    }
    total.add(block);
  }
  return total;
}

}  // namespace lamina
