// SPDX-License-Identifier: GPL-3.0-or-later
// Counts photons at the points of a surface.
#pragma once
#include <vector>

#include "mesh_walk/light_moments.hpp"
#include "mesh_walk/surface_texels.hpp"

namespace lamina {

/// Light that a point has got.
struct Deposit {
  std::int32_t point;
  LightMoments light;
  LightMoments square;  ///< of the light of a sample
};

/// Collects the radiance at the points of a surface where light leaves, for photons of flux 1.
class PhotonTally final : public WalkListener {
 public:
  PhotonTally(const MeshWalk& walk, const SurfaceTexels& texels) : texels_(texels), boundary_(walk.boundary()) {}

  bool leaves(const Meeting& exit) override;

  /// Ends a sample.
  void finish();
  /// The sums over all samples, by point.
  std::vector<Deposit> take();

 private:
  const SurfaceTexels& texels_;
  const SurfaceBoundary& boundary_;
  std::vector<Deposit> sample_;   ///< of the current sample
  std::vector<Deposit> samples_;  ///< of the samples before
};

}  // namespace lamina
