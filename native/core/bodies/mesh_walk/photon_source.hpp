// SPDX-License-Identifier: GPL-3.0-or-later
// Where the light of a lamp meets a solid.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "mesh_walk/lamp.hpp"
#include "mesh_walk/mesh_walk.hpp"
#include "mesh_walk/weight_windows.hpp"

namespace lamina {

/// Draws photons of a lamp where they meet a solid from outside, without those that an occluder reflects on their way.
/// Faces, and patches of large faces, are drawn with probabilities that are about proportional to the flux on them,
/// without shadows.
class PhotonSource {
 public:
  PhotonSource(const Solid& solid, Lamp lamp, const Occluders* occluders = nullptr);

  /// About the flux on the solid, without shadows. Photons have weights relative to this flux.
  double flux() const { return flux_; }
  /// Nothing for light in shadow.
  std::optional<MeshWalk::Photon> photon(Rng& rng, WalkCounts& counts) const;

  /// Photons are split along a walk from now on.
  void split_along(const MeshWalk& walk, ThreadPool& pool) { windows_.emplace(walk, solid_, *this, pool); }
  const WeightWindows* windows() const { return windows_ ? &*windows_ : nullptr; }

 private:
  /// Part `number` of side * side parts of a face, all of one area.
  struct Patch {
    std::uint32_t face;
    std::uint32_t number;
    std::uint32_t side;
  };

  const Solid& solid_;
  Lamp lamp_;
  const Occluders* occluders_;
  double flux_ = 0.0;
  std::vector<Patch> patches_;
  std::vector<double> up_to_;  ///< sums of the patches' probabilities
  std::optional<WeightWindows> windows_;
};

}  // namespace lamina
