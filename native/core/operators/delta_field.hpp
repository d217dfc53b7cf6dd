// SPDX-License-Identifier: GPL-3.0-or-later
// Light that is only mirrored and attenuated, followed through a stack.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "operators/scattering_function.hpp"

namespace lamina {

/// The delta parts of a layer or of several, by direction.
struct Deltas {
  Eigen::ArrayXd reflect_above;
  Eigen::ArrayXd transmit;
  Eigen::ArrayXd reflect_below;

  /// Light passes unchanged.
  static Deltas nothing(Eigen::Index size) {
    return {Eigen::ArrayXd::Zero(size), Eigen::ArrayXd::Ones(size), Eigen::ArrayXd::Zero(size)};
  }
};

/// The adding equations for delta parts.
Deltas joined(const Deltas& above, const Deltas& below);

/// What light that was not scattered by any medium does inside a stack: for each layer and direction, how
/// much of a beam from outside arrives at the layer's top going down and at its bottom going up, all
/// mirror reflections included. By reciprocity the same numbers carry light from the layer out.
struct DeltaField {
  struct Arrival {
    Eigen::VectorXd down;  ///< at the top of the layer
    Eigen::VectorXd up;    ///< at its bottom
  };
  std::vector<Arrival> from_above;  ///< by layer, for a beam from above the stack
  std::vector<Arrival> from_below;

  DeltaField() = default;
  /// Of the layers' own delta parts, top first.
  explicit DeltaField(const std::vector<ScatteringFunction>& layers);
};

}  // namespace lamina
