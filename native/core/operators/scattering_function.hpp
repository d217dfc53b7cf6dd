// SPDX-License-Identifier: GPL-3.0-or-later
// One azimuth order of the scattering function of a layer or a stack.
#pragma once
#include "operators/direction_operator.hpp"
#include "operators/directions.hpp"

namespace lamina {

/// One azimuth order of the scattering function of a layer or a stack, in the symmetric scaling of Directions. By
/// reciprocity reflections are symmetric, and upward transmission is the transpose of downward transmission.
struct ScatteringFunction {
  DirectionOperator reflect_above;  ///< R: from above to above
  DirectionOperator transmit;       ///< T: from above to below; its transpose is T', from below to above
  DirectionOperator reflect_below;  ///< R': from below to below

  ScatteringFunction reversed() const;

  /// A black layer.
  static ScatteringFunction nothing(Eigen::Index size, Eigen::Index nodes,
                                    Eigen::Index views = DirectionOperator::kAllTargets);

  /// Zero delta parts and empty kernels.
  static ScatteringFunction bare(Eigen::Index size, Eigen::Index nodes);

  /// Writes out empty kernels as zeros.
  ScatteringFunction with_kernels() &&;

  /// No layer: light passes unchanged.
  static ScatteringFunction empty(const Directions& directions);

  /// An opaque Lambert surface seen from above. Its kernel is constant, so only azimuth order 0 has one.
  static ScatteringFunction lambert(double reflectance, int order, const Directions& directions);
};

}  // namespace lamina
