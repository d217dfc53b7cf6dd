// SPDX-License-Identifier: GPL-3.0-or-later
// Evaluates the slices of a lookup table: the values of each view column.
#pragma once
#include <Eigen/Core>
#include <span>

#include "table/slice_source.hpp"

namespace lamina {

/// Memory for the results, with axes sight, solution and view cosine.
struct SliceSinks {
  double* values;  ///< f * light cosine in 1/sr, without deltas; a last axis (light cosine, dphi)
  double* lobes;   ///< the part of `values` that facets of rough boundaries scatter once; may be null
  double* albedo;  ///< their exact integral over the light's hemisphere
  double* direct;  ///< specular reflection, or unscattered transmission
};

/// Evaluates all entries of a lookup table of these solutions. Each azimuth order of a solution is joined once for all
/// sights. The values equal those of evaluate_grid and fluxes, to rounding, and do not depend on the number of threads.
void evaluate_slices(std::span<const Solution* const> solutions, std::span<const Sight> sights, const SliceGrid& grid,
                     const SliceSinks& sinks, ThreadPool& pool);

}  // namespace lamina
