// SPDX-License-Identifier: GPL-3.0-or-later
// Positions in space, in millimetres.
#pragma once
#include <cmath>

#include "events/sphere.hpp"

namespace lamina {

struct Place {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  Place moved(const Ray& direction, double distance) const {
    return {x + distance * direction.x, y + distance * direction.y, z + distance * direction.z};
  }
  double distance(const Place& other) const {
    const double dx = x - other.x;
    const double dy = y - other.y;
    const double dz = z - other.z;
    return std::sqrt(dx * dx + dy * dy + dz * dz);
  }
};

}  // namespace lamina
