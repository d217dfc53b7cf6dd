// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lamina {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<double, 3> corner_of(const std::vector<float>& vertices, bool high) {
  std::array<double, 3> corner;
  corner.fill(high ? -kInfinity : kInfinity);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    double& bound = corner[i % 3];
    bound = high ? std::max<double>(bound, vertices[i]) : std::min<double>(bound, vertices[i]);
  }
  return corner;
}

/// The side lengths of a box, each at least .001 of the size.
std::array<double, 3> sides_of(const std::array<double, 3>& low, const std::array<double, 3>& high, double size) {
  std::array<double, 3> sides;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sides[axis] = std::max(high[axis] - low[axis], 1e-3 * size);
  }
  return sides;
}

}  // namespace

Solid::Solid(TrianglePart part, std::vector<bool> opaque, ThreadPool& pool, const std::function<bool(double)>& go_on)
    : low_(corner_of(part.vertices, false)),
      high_(corner_of(part.vertices, true)),
      size_(std::hypot(high_[0] - low_[0], high_[1] - low_[1], high_[2] - low_[2])),
      opaque_(std::move(opaque)),
      scene_({std::move(part)}, pool.threads(), [&](double fraction) { return go_on(0.5 * fraction); }),
      distance_(scene_, low_, sides_of(low_, high_, size_), pool,
                [&](double fraction) { return go_on(0.5 + 0.5 * fraction); }) {}

}  // namespace lamina
