// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/photon_walks.hpp"

#include <algorithm>

#include "mesh_walk/photon_tally.hpp"

namespace lamina {

namespace {

// Number of samples in a piece of work for one thread. The sums of pieces are added in order, for reproducible results.
constexpr std::uint64_t kPiece = 512;

struct Piece {
  std::vector<Deposit> deposits;
  WalkCounts counts;
};

}  // namespace

PhotonSums photons_to_texels(const MeshWalk& walk, const PhotonSource& source, const SurfaceTexels& texels,
                             const PhotonSamples& samples, ThreadPool& pool) {
  std::vector<Piece> pieces((samples.count + kPiece - 1) / kPiece);
  pool.run(pieces.size(), [&](std::size_t task) {
    PhotonTally tally(walk, texels);
    Piece piece;
    const std::uint64_t first = task * kPiece;
    for (std::uint64_t number = first; number < std::min(samples.count, first + kPiece); ++number) {
      Rng rng(samples.seed, samples.first + number);
      for (std::size_t leader = 0; leader < kChannels; ++leader) {
        if (const auto photon = source.photon(rng, piece.counts)) {
          walk.shine(*photon, leader, rng, tally, piece.counts, &source.windows());
        }
      }
      tally.finish();
    }
    piece.deposits = tally.take();
    pieces[task] = std::move(piece);
  });
  const std::size_t points = texels.areas().size();
  PhotonSums found{std::vector<LightMoments>(points), std::vector<LightMoments>(points), {}};
  for (const Piece& piece : pieces) {
    for (const Deposit& one : piece.deposits) {
      const auto point = static_cast<std::size_t>(one.point);
      for (std::size_t i = 0; i < one.light.size(); ++i) {
        found.sums[point][i] += source.flux() * one.light[i];
        found.squares[point][i] += source.flux() * source.flux() * one.square[i];
      }
    }
    found.counts.add(piece.counts);
  }
  return found;
}

}  // namespace lamina
