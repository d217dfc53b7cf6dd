// SPDX-License-Identifier: GPL-3.0-or-later
// Sums the samples of a run on threads in a fixed order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "numeric/rng.hpp"
#include "numeric/thread_pool.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// Sums blocks [first, last) of a walk; the result does not depend on the number of threads. `draw(rng, tally)` adds
/// one sample to a tally, `empty` is a tally without samples.
template <typename Tally, typename Draw>
Tally sum_of_blocks(const Tally& empty, std::uint64_t seed, std::uint64_t first_block, std::uint64_t last_block,
                    ThreadPool& pool, const Draw& draw) {
  // Threads share the work of a block in fixed pieces, summed in order, so that no thread waits long at the end.
  constexpr std::uint64_t kPiece = 512;
  static_assert(kWalkBlock % kPiece == 0);
  std::vector<Tally> pieces((last_block - first_block) * (kWalkBlock / kPiece), empty);
  pool.run(pieces.size(), [&](std::size_t k) {
    Tally tally = empty;
    const std::uint64_t first = first_block * kWalkBlock + k * kPiece;
    for (std::uint64_t sample = first; sample < first + kPiece; ++sample) {
      Rng rng(seed, sample);
      draw(rng, tally);
    }
    pieces[k] = std::move(tally);
  });
  Tally total = empty;
  for (std::size_t first = 0; first < pieces.size(); first += kWalkBlock / kPiece) {
    Tally block = empty;
    for (std::size_t k = first; k < first + kWalkBlock / kPiece; ++k) {
      block.add(pieces[k]);
    }
    total.add(block);
  }
  return total;
}

}  // namespace lamina
