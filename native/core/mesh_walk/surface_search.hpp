// SPDX-License-Identifier: GPL-3.0-or-later
// Where a straight flight leaves or enters a solid.
#pragma once
#include "mesh_walk/solid.hpp"

namespace lamina {

/// Looks for the surface along a ray, a stretch at a time. Parts of a mesh may overlap: `shells` counts how many the
/// flight is inside of, and only the outermost surface counts.
class SurfaceSearch {
 public:
  /// A ray that starts on the surface may start on the wrong side of the surface by rounding.
  SurfaceSearch(const Solid& solid, const Place& from, const Ray& direction, int& shells, bool on_surface)
      : solid_(solid),
        from_(from),
        direction_(direction),
        shells_(shells),
        rounding_((on_surface ? 1e-4 : 1e-6) * solid.size()) {}

  /// Where a flight inside leaves, up to the distance `farthest` from its start.
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

  /// Where a flight outside enters.
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
    // The next stretch begins behind the face that was found.
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
