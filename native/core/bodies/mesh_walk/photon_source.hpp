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
/// without shadows. Photons along the walk are to be split by weight windows.
class PhotonSource {
 public:
  PhotonSource(const MeshWalk& walk, const Solid& solid, Lamp lamp, const Occluders* occluders, ThreadPool& pool);

  /// About the flux on the solid, without shadows. Photons have weights relative to this flux.
  double flux() const { return flux_; }
  /// Nothing for light in shadow.
  std::optional<MeshWalk::Photon> photon(Rng& rng, WalkCounts& counts) const;

  const WeightWindows& windows() const { return *windows_; }

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
  std::vector<double> up_to_;             ///< sums of the patches' probabilities
  std::optional<WeightWindows> windows_;  ///< made last, from photons of this source
};

}  // namespace lamina
