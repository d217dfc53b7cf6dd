// SPDX-License-Identifier: GPL-3.0-or-later
// Dust that falls on points of a mesh: rays from each point towards the directions that grains come from.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mesh/mesh_scene.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

using Vec3f = std::array<float, 3>;

/// How grains fall. A grain comes from the direction d = up + t, where t = rho (cos phi, sin phi) - wind is horizontal.
/// Without wind the directions fill a cone uniformly in solid angle, weighted by the flux through a horizontal plane
/// (sin^2 theta uniform, tan theta = rho). The wind's velocity is relative to the speed of the fall.
/// A face with normal n gets n.d times the dust of an open horizontal face.
struct Fall {
  Vec3f up, across1, across2;  // orthonormal
  float wind1, wind2;
  float sin_spread;  // of the half-angle of the cone, below 1
};

/// The share of an unoccluded point: the mean of max(0, n.d). It is n.up - n.wind where the whole cone is above the
/// point's plane.
class OpenShare {
 public:
  explicit OpenShare(const Fall& fall);
  /// For a unit normal, by its components along up, across1 and across2.
  double operator()(double up, double across1, double across2) const;

 private:
  static constexpr int kIntervals = 1024;
  double wind1_, wind2_, spread_;
  std::vector<double> table_;  // over angles atan(c / b) in [-spread, spread], for n.d = c + b (rho cos phi)
};

/// The points that rays start from. A point's random numbers depend on the seed and on its number only.
struct PointSet {
  const float* positions;  // x y z each
  const float* normals;    // of length 1, or 0: no dust there
  std::size_t count;
  std::uint64_t first_number;
};

struct ArrivalOptions {
  int rays;
  std::uint64_t seed;
  bool two_sided;
  float offset;  // of the origin along the normal, relative to the larger of 1 and the point's coordinates
};

/// Writes to `shares` the dust that arrives at each point, relative to an open horizontal plane: one share per point,
/// or with two_sided two, front (the side that the normal points to) and back. Returns the number of rays traced. The
/// visibility is averaged with the weights n.d and scaled by OpenShare, so that unoccluded points are exact. A single
/// ray counts with its own weight instead, because the ratio of the sums would be biased.
std::uint64_t dust_arrivals(const MeshScene& scene, const Fall& fall, const OpenShare& open, const PointSet& points,
                            const ArrivalOptions& options, float* shares, ThreadPool& pool);

/// The cosine-weighted share of the hemisphere above each point that is open up to the distance `reach`; 1 where the
/// normal is 0. Returns the number of rays traced.
std::uint64_t dust_exposures(const MeshScene& scene, const PointSet& points, const ArrivalOptions& options, float reach,
                             float* exposures, ThreadPool& pool);

/// How convex the body is at each point, in [0, 1]: by rays into the body that leave it within the distance `reach`
/// through another side. 1 at edges of 90 degrees and less, falling over `reach` beside them; 0 on flat faces, in
/// concave corners, and where the normal is 0. With two_sided, normals of faces may be turned. Returns the number of
/// rays traced.
std::uint64_t dust_convexities(const MeshScene& scene, const PointSet& points, const ArrivalOptions& options,
                               float reach, float* convexities, ThreadPool& pool);

/// The parallelogram that grains pass through: corner + a edge1 + b edge2 with a, b in [0, 1], in a horizontal plane
/// above part 0.
struct GrainTarget {
  Vec3f corner, edge1, edge2;
};

/// Numbers of grains: on the front and on the back of part 0, on no part, and on each other part (`stopped`, whose
/// first entry is 0).
struct GrainCount {
  std::uint64_t front = 0, back = 0, missed = 0;
  std::vector<std::uint64_t> stopped;
};

/// Traces single grains, with rays and random numbers of its own, as a check of dust_arrivals. Each grain is traced
/// from the target upwards, to a part that has stopped it before, and then downwards. Rays from above the highest part
/// would lose precision where that part is far away.
GrainCount trace_grains(const MeshScene& scene, const Fall& fall, const GrainTarget& target, std::uint64_t grains,
                        std::uint64_t seed, ThreadPool& pool);

}  // namespace lamina
