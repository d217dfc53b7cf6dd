// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of a stack with anisotropic facets: the light of many directions that is reflected to each of many views.
#pragma once
#include <Eigen/Core>

#include "numeric/thread_pool.hpp"
#include "oriented/beam_set.hpp"
#include "oriented/oriented_solution.hpp"

namespace lamina {

/// Views and lights on product grids. Azimuths are those of directions of travel, in the frame of the stack; the
/// light's is `phi_o` - `dphi`. Cosines in air.
struct OrientedGrid {
  Eigen::VectorXd mu_o;
  Eigen::VectorXd phi_o;
  Eigen::VectorXd mu_i;
  Eigen::VectorXd dphi;
};

/// Views run over azimuths, and over the cosines of each; lights over cosines, and over the azimuths of each.
struct OrientedSlices {
  Eigen::MatrixXf values;    ///< f * mu_i in 1/sr, without deltas, [light, view]
  Eigen::VectorXd albedo;    ///< their integrals, by the solver's fluxes, [view]
  Eigen::VectorXd mirrored;  ///< specular reflectance, [view]
};

/// Reflection to the top. What facets scatter once is exact. All other light is smooth: it is known for some beams, as
/// many as the solution has nodes and functions, and interpolated between them, by cubics in the angle from the normal
/// and by Fourier series in the azimuth.
OrientedSlices oriented_slices(const OrientedSolution& solution, const OrientedGrid& grid, ThreadPool& pool);

/// Slices for many thicknesses of the medium on top of a stack. What does not depend on the thickness is kept: the
/// first scattering below the medium, by facets and into the nodes.
class SlicesBelowMedium {
 public:
  /// `bare`: the stack where the medium on top has the thickness 0; it must outlive this.
  SlicesBelowMedium(const OrientedSolution& bare, OrientedGrid grid, ThreadPool& pool);
  /// The slices of the stack of another thickness: see OrientedSolution::with_top_thickness.
  OrientedSlices of(const OrientedSolution& solution, ThreadPool& pool) const;

 private:
  OrientedGrid grid_;
  BeamSet beams_;
  Eigen::MatrixXf facets_;  // light that facets scatter once, in 1/sr, [light, view]
};

}  // namespace lamina
