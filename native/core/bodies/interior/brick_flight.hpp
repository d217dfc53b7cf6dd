// SPDX-License-Identifier: GPL-3.0-or-later
// A straight flight through the bricks of a grid.
#pragma once
#include <limits>

#include "interior/coefficient_grid.hpp"

namespace lamina {

/// Traverses the bricks of a grid along a ray. Bricks at the border of the grid extend to infinity.
class BrickFlight {
 public:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// `channel`: whose majorant is used; kChannels: the largest of all.
  BrickFlight(const CoefficientGrid& grid, const Place& from, const Ray& direction, std::size_t channel)
      : grid_(grid), channel_(channel) {
    const std::array<double, 3> origin = {from.x, from.y, from.z};
    const std::array<double, 3> along = {direction.x, direction.y, direction.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double speed = along[axis] * grid.bricks_per_mm()[axis];
      const double place = (origin[axis] - grid.low()[axis]) * grid.bricks_per_mm()[axis];
      brick_[axis] = static_cast<int>(std::clamp(place, 0.0, grid.bricks()[axis] - 1.0));
      step_[axis] = speed < 0.0 ? -1 : 1;
      last_[axis] = speed < 0.0 ? 0 : grid.bricks()[axis] - 1;
      per_brick_[axis] = 1.0 / std::abs(speed);
      const double face = brick_[axis] + (speed < 0.0 ? 0.0 : 1.0);
      next_[axis] = brick_[axis] == last_[axis] || speed == 0.0 ? kInfinity : (face - place) / speed;
    }
    majorant_ = grid.majorant(brick_, channel_);
  }

  /// Advances until the integral of the majorant reaches the optical depth `depth`. Returns the distance from the start
  /// in mm, or infinity if `depth` is not reached before the distance `limit`.
  double advance(double depth, double limit) {
    for (;;) {
      const std::size_t axis = next_axis();
      const double inside = (next_[axis] - at_) * majorant_;
      if (depth < inside) {
        at_ += depth / majorant_;
        return at_ < limit ? at_ : kInfinity;
      }
      if (!(next_[axis] < limit)) {
        return kInfinity;
      }
      depth -= inside;
      enter_brick(axis);
    }
  }

  /// Advances to this distance from the start without accumulating optical depth.
  void skip_to(double distance) {
    for (std::size_t axis = next_axis(); next_[axis] < distance; axis = next_axis()) {
      enter_brick(axis);
    }
    at_ = distance;
  }

  /// The majorant of the current brick, in 1/mm.
  double majorant() const { return majorant_; }

 private:
  std::size_t next_axis() const {
    return next_[0] < next_[1] ? (next_[0] < next_[2] ? 0 : 2) : (next_[1] < next_[2] ? 1 : 2);
  }

  void enter_brick(std::size_t axis) {
    at_ = next_[axis];
    brick_[axis] += step_[axis];
    next_[axis] = brick_[axis] == last_[axis] ? kInfinity : next_[axis] + per_brick_[axis];
    majorant_ = grid_.majorant(brick_, channel_);
  }

  const CoefficientGrid& grid_;
  std::size_t channel_;
  std::array<int, 3> brick_;
  std::array<int, 3> step_;
  std::array<int, 3> last_;
  std::array<double, 3> per_brick_;  ///< mm
  std::array<double, 3> next_;       ///< distance to the next face
  double at_ = 0.0;
  double majorant_ = 0.0;
};

}  // namespace lamina
