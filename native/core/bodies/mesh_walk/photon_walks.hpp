// SPDX-License-Identifier: GPL-3.0-or-later
// Multithreaded photons of a lamp, counted where they leave a solid.
#pragma once
#include <vector>

#include "mesh_walk/light_moments.hpp"
#include "mesh_walk/photon_source.hpp"
#include "mesh_walk/surface_texels.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// Samples [first, first + count) of three photons each, led by the three channels; random numbers depend on the seed
/// and the number of the sample.
struct PhotonSamples {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
  std::uint64_t seed = 0;
};

/// Sums over samples of the radiance at each point, and of its squares.
struct PhotonSums {
  std::vector<LightMoments> sums;
  std::vector<LightMoments> squares;
  WalkCounts counts;
};

/// Estimates the radiance, as a mean over the surface of each point, of the light of a lamp that leaves there after
/// transport inside. Results are identical bytes for any number of threads.
PhotonSums photons_to_texels(const MeshWalk& walk, const PhotonSource& source, const SurfaceTexels& texels,
                             const PhotonSamples& samples, ThreadPool& pool);

}  // namespace lamina
