// SPDX-License-Identifier: GPL-3.0-or-later
// A solved stack on all nodes and target directions, its layers joined on demand.
#pragma once
#include <vector>

#include "operators/delta_field.hpp"
#include "solve/solution.hpp"

namespace lamina {

/// A solved stack for a list of target directions in air: the layers' scattering functions on all nodes and targets,
/// joined on demand.
class Assembly {
 public:
  /// With `views` (see Directions) kernels are joined only between views and lights.
  Assembly(const Solution& solution, const Eigen::VectorXd& targets, ThreadPool& pool,
           Eigen::Index views = DirectionOperator::kAllTargets);
  /// Directions and delta field only, for any number of targets. Such an assembly has no layers to join.
  Assembly(const Solution& solution, const Eigen::VectorXd& targets);

  const Solution& solution() const { return solution_; }
  /// The directions in the media between the layers, top first: one more than layers.
  const std::vector<Directions>& directions() const { return directions_; }
  /// A rough boundary on these directions.
  const RoughSurface::Operators& surface(std::size_t boundary) const { return surfaces_[boundary]; }
  /// Specular light that no medium and no rough boundary has scattered; by layer, the base last.
  const DeltaField& deltas() const { return deltas_; }

  /// The whole stack in one azimuth order. Lobes of rough boundaries between two targets are left out.
  ScatteringFunction joined(int order) const { return joined(order, once(order), false); }

  /// The stack without single scattering by a medium or a rough boundary, and without delta parts: smooth in azimuth.
  /// Kernels are those between targets; other blocks are undefined.
  ScatteringFunction without_single(int order) const;

 private:
  /// The single scattering of each medium in one order.
  std::vector<LayerKernels> once(int order) const;
  /// The layers, top first; only their delta parts if `once` is null.
  std::vector<ScatteringFunction> layers(int order, const std::vector<LayerKernels>* once) const;
  /// With `between_targets`, only kernels between targets are computed.
  ScatteringFunction joined(int order, const std::vector<LayerKernels>& once, bool between_targets) const;

  const Solution& solution_;
  std::vector<Directions> directions_;
  std::vector<RoughSurface::Operators> surfaces_;  // by rough boundary
  std::vector<LayerShapes> shapes_;                // by medium
  DeltaField deltas_;
};

}  // namespace lamina
