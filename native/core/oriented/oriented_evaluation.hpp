// SPDX-License-Identifier: GPL-3.0-or-later
// BRDF, BTDF and fluxes of a stack with anisotropic facets.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "oriented/oriented_solution.hpp"
#include "solve/evaluation.hpp"

namespace lamina {

/// Lists of equal length: cosines, dphi as for evaluate_points, and the azimuth of the outgoing light.
struct OrientedPoints {
  Eigen::VectorXd mu_o;
  Eigen::VectorXd mu_i;
  Eigen::VectorXd dphi;
  Eigen::VectorXd phi_o;
};

/// The values at a list of points, in 1/sr, without deltas.
std::vector<double> evaluate_oriented(const OrientedSolution& solution, Side side, Path path,
                                      const OrientedPoints& points, ThreadPool& pool);

/// The problems `first` to `first` + `size` - 1.
GapLight columns(const GapLight& light, Eigen::Index first, Eigen::Index size);

/// The flux of radiance on nodes that leaves a face, for each problem.
Eigen::VectorXd leaving(const OrientedSolution& solution, const GapLight& light, bool above);

/// Hemispherical fluxes for beams that travel along azimuths `phi`, relative to the incident flux.
Fluxes oriented_fluxes(const OrientedSolution& solution, Side side, const Eigen::VectorXd& mu,
                       const Eigen::VectorXd& phi, ThreadPool& pool);

/// Hemispherical fluxes for uniform diffuse light.
Fluxes oriented_diffuse_fluxes(const OrientedSolution& solution, Side side, ThreadPool& pool);

}  // namespace lamina
