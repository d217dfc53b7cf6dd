// SPDX-License-Identifier: GPL-3.0-or-later
// Finds where a straight flight leaves or enters a solid.
#pragma once
#include <limits>
#include <vector>

#include "mesh_walk/solid.hpp"

namespace lamina {

/// Searches the surface along a ray, segment by segment. Parts of a mesh may overlap: `shells` is the number of parts
/// that contain the start, and only the outermost surface counts.
class SurfaceSearch {
 public:
  /// `on_surface`: the ray starts on the surface, where rounding errors may put the start on the wrong side.
  SurfaceSearch(const Solid& solid, const Place& from, const Ray& direction, int shells, bool on_surface)
      : solid_(solid),
        from_(from),
        direction_(direction),
        shells_(shells),
        rounding_((on_surface ? 1e-4 : 1e-6) * solid.size()) {}

  /// The point where a flight inside leaves the solid or meets an opaque face, up to the distance `farthest` from the
  /// start.
  std::optional<Crossing> leaving(double farthest) {
    while (const auto crossing = next(farthest)) {
      const bool leaves = crossing->normal.dot(direction_) > 0.0;
      if (crossing->is_opaque && (leaves || crossing->distance > rounding_)) {
        return crossing;
      }
      if (leaves) {
        if (shells_ == 1) {
          return crossing;
        }
        left_ = crossing;
        step(crossing->distance, -1);
      } else if (crossing->distance > rounding_) {
        step(crossing->distance, 1);
      }
    }
    // Where faces of two parts coincide, the ray meets one of them: the last one that it left was the outermost.
    return farthest == std::numeric_limits<double>::infinity() ? left_ : std::nullopt;
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

  /// The number of parts that the whole ray enters, less the number of parts that it leaves.
  int shells_on_the_way() {
    int entered = 0;
    while (const auto crossing = next(std::numeric_limits<double>::infinity())) {
      entered += crossing->normal.dot(direction_) < 0.0 ? 1 : -1;
    }
    return entered;
  }

  /// The number of parts that contain the position at `distance`, before the first point that `leaving` returned.
  int shells_at(double distance) const {
    int shells = shells_;
    for (const Step& step : steps_) {
      if (step.distance > distance) {
        shells -= step.change;
      }
    }
    return shells;
  }

 private:
  /// An inner surface on the way: the flight enters (1) or leaves (-1) one of several overlapping parts.
  struct Step {
    double distance;
    int change;
  };

  void step(double distance, int change) {
    shells_ += change;
    steps_.push_back({distance, change});
  }

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
  int shells_;
  std::vector<Step> steps_;
  std::optional<Crossing> left_;  ///< the last surface of an inner part that the flight left
  double rounding_;
  double nearest_ = 0.0;
};

}  // namespace lamina
