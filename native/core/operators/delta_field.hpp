// SPDX-License-Identifier: GPL-3.0-or-later
// Specular light in a stack: reflected, refracted and attenuated, but not scattered.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "operators/scattering_function.hpp"

namespace lamina {

/// The delta parts of one or several layers, by direction.
struct Deltas {
  Eigen::ArrayXd reflect_above;
  Eigen::ArrayXd transmit;
  Eigen::ArrayXd reflect_below;

  /// No layer: light passes unchanged.
  static Deltas nothing(Eigen::Index size) {
    return {Eigen::ArrayXd::Zero(size), Eigen::ArrayXd::Ones(size), Eigen::ArrayXd::Zero(size)};
  }
};

/// The adding equations for delta parts.
Deltas joined(const Deltas& above, const Deltas& below);

/// The specular light inside a stack: for each layer and direction, the share of a beam from outside that arrives at
/// the layer's top going down and at its bottom going up, with all mirror reflections. By reciprocity the same numbers
/// hold for specular light from the layer to the outside.
struct DeltaField {
  struct Arrival {
    Eigen::VectorXd down;  ///< at the top of the layer
    Eigen::VectorXd up;    ///< at its bottom
  };
  std::vector<Arrival> from_above;  ///< by layer, for a beam from above the stack
  std::vector<Arrival> from_below;

  DeltaField() = default;
  /// `layers` are scattering functions, top first; only their delta parts are used.
  explicit DeltaField(const std::vector<ScatteringFunction>& layers);
  explicit DeltaField(const std::vector<Deltas>& own);
};

}  // namespace lamina
