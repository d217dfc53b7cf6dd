// SPDX-License-Identifier: GPL-3.0-or-later
// Evaluates the slices of a lookup table: the values that each view column sees.
#pragma once
#include <Eigen/Core>
#include <span>

#include "table/slice_source.hpp"

namespace lamina {

/// Where the results for each sight, solution and view cosine go, in that order of axes.
struct SliceSinks {
  double* values;  ///< f * light cosine in 1/sr, without deltas; a last axis (light cosine, dphi)
  double* lobes;   ///< of these, what facets of rough boundaries scatter once; null where none are wanted
  double* albedo;  ///< their exact integral over the light's hemisphere
  double* direct;  ///< light that mirrors reflect, or that passes unscattered
};

/// All that a lookup table of these solutions holds, in one pass: each azimuth order of a solution is joined
/// once, for all sights. The same numbers as evaluate_grid and fluxes, to rounding. Results do not depend on
/// the threads.
void evaluate_slices(std::span<const Solution* const> solutions, std::span<const Sight> sights, const SliceGrid& grid,
                     const SliceSinks& sinks, ThreadPool& pool);

}  // namespace lamina
