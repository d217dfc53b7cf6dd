// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "evaluation.hpp"

namespace lamina {

/// What a viewer above (top) or below (bottom) a stack sees: light that came in on the viewer's side
/// (reflect) or on the other one (transmit).
struct Sight {
  Side viewer = Side::kTop;
  Path path = Path::kReflect;
};

/// The product grid of a lookup table.
struct SliceGrid {
  Eigen::VectorXd view_mu;
  Eigen::VectorXd light_mu;
  Eigen::VectorXd dphi;

  Eigen::Index lights() const { return light_mu.size() * dphi.size(); }
};

/// Where the results for each sight, solution and view cosine go, in that order of axes.
struct SliceSinks {
  double* values;  ///< f * light cosine in 1/sr, without deltas; a last axis (light cosine, dphi)
  double* albedo;  ///< their exact integral over the light's hemisphere
  double* direct;  ///< unscattered light: 0 for reflect
};

/// All that a lookup table of these solutions holds, in one pass: each azimuth order of a solution is joined
/// once, for all sights, and only between views and lights. The same numbers as evaluate_grid and fluxes, to
/// rounding. Results do not depend on the threads. Media over nothing or a Lambert surface only: throws
/// std::invalid_argument where there is a dielectric boundary or a conductor.
void evaluate_slices(std::span<const Solution* const> solutions, std::span<const Sight> sights, const SliceGrid& grid,
                     const SliceSinks& sinks, ThreadPool& pool);

}  // namespace lamina
