// SPDX-License-Identifier: GPL-3.0-or-later
// The segment of a flight as a ray for meshes.
#pragma once
#include <algorithm>
#include <limits>

#include "interior/place.hpp"
#include "mesh/mesh_scene.hpp"

namespace lamina {

/// The part of a flight between two distances; `farthest` may be infinite.
inline MeshRay flight_ray(const Place& from, const Ray& direction, double nearest, double farthest) {
  constexpr double kFar = std::numeric_limits<float>::max();
  return {{static_cast<float>(from.x), static_cast<float>(from.y), static_cast<float>(from.z)},
          {static_cast<float>(direction.x), static_cast<float>(direction.y), static_cast<float>(direction.z)},
          static_cast<float>(nearest),
          static_cast<float>(std::min(farthest, kFar))};
}

}  // namespace lamina
