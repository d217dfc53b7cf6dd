// SPDX-License-Identifier: GPL-3.0-or-later
// Where the light of a lamp meets a solid.
#pragma once
#include <optional>
#include <vector>

#include "mesh_walk/lamp.hpp"
#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// Draws photons of a lamp where they meet a solid from outside. Faces are drawn with probabilities that are about
/// proportional to the flux on them, without shadows.
class PhotonSource {
 public:
  PhotonSource(const Solid& solid, Lamp lamp);

  /// About the flux on the solid, without shadows. Photons have weights relative to this flux.
  double flux() const { return flux_; }
  /// Nothing for light in shadow.
  std::optional<MeshWalk::Photon> photon(Rng& rng, WalkCounts& counts) const;

 private:
  const Solid& solid_;
  Lamp lamp_;
  double flux_ = 0.0;
  std::vector<double> up_to_;  ///< sums of probabilities
};

}  // namespace lamina
