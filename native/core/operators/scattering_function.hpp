// SPDX-License-Identifier: GPL-3.0-or-later
// One azimuth order of the scattering function of a layer or a stack.
#pragma once
#include "operators/direction_operator.hpp"
#include "operators/directions.hpp"

namespace lamina {

/// One azimuth order of the scattering function of a layer or a stack, in the symmetric scaling of
/// Directions. Reciprocity makes the reflections symmetric and the way up the transpose of the way down.
struct ScatteringFunction {
  DirectionOperator reflect_above;  ///< R: from above to above
  DirectionOperator transmit;       ///< T: from above to below; its transpose is T', from below to above
  DirectionOperator reflect_below;  ///< R': from below to below

  ScatteringFunction reversed() const;

  /// Absorbs everything.
  static ScatteringFunction nothing(Eigen::Index size, Eigen::Index nodes,
                                    Eigen::Index views = DirectionOperator::kAllTargets);

  /// Delta parts alone, all zero; kernels of no size, for lists of targets too long for them.
  static ScatteringFunction bare(Eigen::Index size, Eigen::Index nodes);

  /// The same with kernels that are zero.
  ScatteringFunction with_zero_kernels() const;

  /// Nothing there: light passes unchanged.
  static ScatteringFunction empty(const Directions& directions);

  /// A Lambert surface seen from above; nothing comes through. Its kernel is the same for all
  /// directions, so only azimuth order 0 has any.
  static ScatteringFunction lambert(double reflectance, int order, const Directions& directions);
};

}  // namespace lamina
