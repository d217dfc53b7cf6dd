// SPDX-License-Identifier: GPL-3.0-or-later
// Finds where a straight flight leaves or enters a solid.
#pragma once
#include "mesh_walk/solid.hpp"

namespace lamina {

/// Searches the surface along a ray, segment by segment. Parts of a mesh may overlap: `shells` is the number of parts
/// that contain the current position, and only the outermost surface counts.
class SurfaceSearch {
 public:
  /// `on_surface`: the ray starts on the surface, where rounding errors may put the start on the wrong side.
  SurfaceSearch(const Solid& solid, const Place& from, const Ray& direction, int& shells, bool on_surface)
      : solid_(solid),
        from_(from),
        direction_(direction),
        shells_(shells),
        rounding_((on_surface ? 1e-4 : 1e-6) * solid.size()) {}

  /// The point where a flight inside leaves the solid, up to the distance `farthest` from the start.
  std::optional<Crossing> leaving(double farthest) {
    while (const auto crossing = next(farthest)) {
      if (crossing->normal.dot(direction_) > 0.0) {
        if (shells_ == 1) {
          return crossing;
        }
        --shells_;
      } else if (crossing->distance > rounding_) {
        ++shells_;
      }
    }
    return std::nullopt;
  }

  /// The point where a flight outside enters the solid, up to the distance `farthest` from the start.
  std::optional<Crossing> entering(double farthest) {
    while (const auto crossing = next(farthest)) {
      if (crossing->normal.dot(direction_) < 0.0) {
        shells_ = 1;
        return crossing;
      }
    }
    return std::nullopt;
  }

 private:
  std::optional<Crossing> next(double farthest) {
    if (!(nearest_ < farthest)) {
      return std::nullopt;
    }
    const auto crossing = solid_.first_crossing(from_, direction_, nearest_, farthest);
    // The next segment begins behind the face that was hit.
    constexpr double kBehind = 1.0 + 1e-6;
    nearest_ = crossing ? crossing->distance * kBehind + 1e-7 * solid_.size() : farthest;
    return crossing;
  }

  const Solid& solid_;
  const Place& from_;
  const Ray& direction_;
  int& shells_;
  double rounding_;
  double nearest_ = 0.0;
};

}  // namespace lamina
