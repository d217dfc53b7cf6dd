// SPDX-License-Identifier: GPL-3.0-or-later
// Dust that falls on points among triangles: rays from each point to where grains come from.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "dust/mesh.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

using Vec3f = std::array<float, 3>;

/// How grains fall. A grain comes from the direction d = up + t, t = rho (cos phi, sin phi) - wind across gravity:
/// without wind evenly over the solid angle of a cone, each direction weighted by its share of the flux through a
/// horizontal plane (sin^2 theta uniform, tan theta = rho); wind adds its velocity over that of the fall.
/// A face with normal n then gets the share n.d of what an open horizontal one gets.
struct Fall {
  Vec3f up, across1, across2;  // orthonormal
  float wind1, wind2;
  float sin_spread;  // of the half-angle of the cone, below 1
};

/// The share that a point gets when nothing is in the way: the mean of max(0, n.d), exactly n.up - n.wind as long
/// as the whole cone is above the point's plane.
class OpenShare {
 public:
  explicit OpenShare(const Fall& fall);
  /// Of a unit normal given along up, across1 and across2.
  double operator()(double up, double across1, double across2) const;

 private:
  static constexpr int kIntervals = 1024;
  double wind1_, wind2_, spread_;
  std::vector<double> table_;  // over angles atan(c / b) in [-spread, spread], for n.d = c + b (rho cos phi)
};

/// Where rays start, and their count. A point's numbers depend on the seed and its own number only.
struct PointSet {
  const float* positions;  // x y z each
  const float* normals;    // of length 1, or 0: nothing falls there
  std::size_t count;
  std::uint64_t first_number;
};

struct ArrivalOptions {
  int rays;
  std::uint64_t seed;
  bool two_sided;
  float offset;  // off the surface along the normal, relative to the larger of 1 and the point's coordinates
};

/// The share of an open horizontal plane's dust that arrives at each point, into `shares`: one a point, or two when the
/// options say two_sided, of the side that the normal points to and of the other. Returns the number of rays traced.
/// Visibility is averaged with the weights n.d and scaled by OpenShare: exact where all is open, exactly zero where
/// nothing is. With a single ray its weight is taken instead, since the ratio of two such sums would be biased.
std::uint64_t dust_arrivals(const MeshScene& scene, const Fall& fall, const OpenShare& open, const PointSet& points,
                            const ArrivalOptions& options, float* shares, ThreadPool& pool);

/// The cosine-weighted share of the hemisphere over each point that is open up to `reach`; 1 where the normal is 0.
std::uint64_t dust_exposures(const MeshScene& scene, const PointSet& points, const ArrivalOptions& options, float reach,
                             float* exposures, ThreadPool& pool);

/// What grains pass through: corner + a edge1 + b edge2 with a, b in [0, 1], in a horizontal plane above part 0.
struct GrainTarget {
  Vec3f corner, edge1, edge2;
};

/// What became of grains: on the front or the back of part 0, on none; and on each part but 0, whose count is 0.
struct GrainCount {
  std::uint64_t front = 0, back = 0, missed = 0;
  std::vector<std::uint64_t> stopped;
};

/// Traces grains from above, independent of dust_arrivals in rays and random numbers. Both ways from the target, up to
/// what has stopped a grain before and down to what stops it then: rays that started above the highest part would lose
/// the target's digits where that part is far away.
GrainCount trace_grains(const MeshScene& scene, const Fall& fall, const GrainTarget& target, std::uint64_t grains,
                        std::uint64_t seed, ThreadPool& pool);

}  // namespace lamina
