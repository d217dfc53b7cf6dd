// SPDX-License-Identifier: GPL-3.0-or-later
// A grid of distances to a surface. Flights shorter than the distance need no ray.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "interior/place.hpp"
#include "mesh/mesh_scene.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// Lower bounds of the distance to the surface of a scene. Near the surface, cells store the exact distance of their
/// centre. Other cells store the distance to the nearest cell that the surface may cross (distance transform of
/// Felzenszwalb and Huttenlocher 2012).
class SurfaceDistance {
 public:
  /// Covers a box in mm with sides above 0. Calls `go_on(fraction)` from time to time. Throws MeshScene::Stopped if
  /// `go_on` returns false.
  SurfaceDistance(const MeshScene& scene, const std::array<double, 3>& low, const std::array<double, 3>& sides,
                  ThreadPool& pool, const std::function<bool(double)>& go_on);

  /// A lower bound in mm of the distance to the surface; 0 if no bound is known.
  double clearance(const Place& place) const {
    const std::array<double, 3> u = {(place.x - low_[0]) * per_mm_, (place.y - low_[1]) * per_mm_,
                                     (place.z - low_[2]) * per_mm_};
    std::size_t index = 0;
    double square = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int cell = static_cast<int>(u[axis]);
      if (!(u[axis] >= 0.0 && u[axis] < cells_[axis])) {
        return 0.0;
      }
      const double off = u[axis] - (cell + 0.5);
      square += off * off;
      index = index * static_cast<std::size_t>(cells_[axis]) + static_cast<std::size_t>(cell);
    }
    // The distance to the surface changes by at most the distance between two positions.
    const double here = distances_[index];
    return here * here > square ? (here - std::sqrt(square)) * cell_ : 0.0;
  }

  std::size_t bytes() const { return distances_.size() * sizeof(float); }

 private:
  void measure_near(const MeshScene& scene, double rounding, ThreadPool& pool,
                    const std::function<bool(double)>& go_on);
  void fill_far(ThreadPool& pool);

  std::array<double, 3> low_;
  std::array<int, 3> cells_ = {};
  double cell_;                   ///< side in mm
  double per_mm_;                 ///< cells per mm
  std::vector<float> distances_;  ///< in cells
};

}  // namespace lamina
