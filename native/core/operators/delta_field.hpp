// SPDX-License-Identifier: GPL-3.0-or-later
// Specular light in a stack: reflected, refracted and attenuated, but not scattered.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "operators/scattering_function.hpp"

namespace lamina {

/// The delta parts of one or several layers, by direction. `size`: the number of directions, Eigen::Dynamic or 1; a
/// single direction takes no memory of its own.
template <int size>
struct DeltasOf {
  using Share = Eigen::Array<double, size, 1>;
  Share reflect_above;
  Share transmit;
  Share reflect_below;

  /// No layer: light passes unchanged.
  static DeltasOf nothing(Eigen::Index count) { return {Share::Zero(count), Share::Ones(count), Share::Zero(count)}; }
};
using Deltas = DeltasOf<Eigen::Dynamic>;

/// The adding equations for delta parts.
template <int size>
DeltasOf<size> joined(const DeltasOf<size>& above, const DeltasOf<size>& below);

/// The specular light inside a stack: for each layer and direction, the share of a beam from outside that arrives at
/// the layer's top going down and at its bottom going up, with all mirror reflections. By reciprocity the same numbers
/// hold for specular light from the layer to the outside.
template <int size>
struct DeltaFieldOf {
  struct Arrival {
    Eigen::Vector<double, size> down;  ///< at the top of the layer
    Eigen::Vector<double, size> up;    ///< at its bottom
  };
  std::vector<Arrival> from_above;  ///< by layer, for a beam from above the stack
  std::vector<Arrival> from_below;

  DeltaFieldOf() = default;
  explicit DeltaFieldOf(const std::vector<DeltasOf<size>>& own);
  /// `layers` are scattering functions, top first; only their delta parts are used.
  explicit DeltaFieldOf(const std::vector<ScatteringFunction>& layers)
    requires(size == Eigen::Dynamic);
};
using DeltaField = DeltaFieldOf<Eigen::Dynamic>;

}  // namespace lamina
