// SPDX-License-Identifier: GPL-3.0-or-later
// BRDF, BTDF and fluxes of a solved stack.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "solve/solution.hpp"

namespace lamina {

class Assembly;
class FacetMeetings;
class ScatteringBetweenLobes;

enum class Side { kTop, kBottom };
enum class Path { kReflect, kTransmit };

/// BRDF or BTDF (1/sr, without deltas) of a solved stack on a product grid: result[(o * mu_i.size() + i) * dphi.size()
/// + p]. Light enters on `side`. Cosines in (0, 1] are those in the medium of each ray; dphi = 0 means that light keeps
/// its azimuth.
std::vector<double> evaluate_grid(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                  const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool);

/// The side where light enters, and reflection or transmission; evaluate_grids assembles the stack once for several.
struct Passage {
  Side side;
  Path path;
};
/// For each passage and azimuth order, the smooth part of pi f between all targets of an assembly. Single scattering by
/// media, and single and double scattering by facets, are not part of it.
std::vector<std::vector<Eigen::MatrixXd>> smooth_orders(const Assembly& assembly, const FacetMeetings& meetings,
                                                        const ScatteringBetweenLobes& between,
                                                        const std::vector<Passage>& passages, ThreadPool& pool);
std::vector<std::vector<double>> evaluate_grids(const Solution& solution, const std::vector<Passage>& passages,
                                                const Eigen::VectorXd& mu_o, const Eigen::VectorXd& mu_i,
                                                const Eigen::VectorXd& dphi, ThreadPool& pool);

/// The values at a list of points (mu_o, mu_i, dphi), given as three lists of equal length. The smooth part
/// of one pair of directions under a rough boundary, and of more than 241 cosines, comes from a table that the solution
/// keeps: errors of some 1e-5, and a first call that takes a few times as long as the solve.
std::vector<double> evaluate_points(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                    const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool);

/// Hemispherical fluxes for a beam from each direction, relative to the incident flux.
struct Fluxes {
  Eigen::VectorXd reflected;    ///< without specular reflection
  Eigen::VectorXd mirrored;     ///< specular reflection
  Eigen::VectorXd transmitted;  ///< without the unscattered beam
  Eigen::VectorXd direct;       ///< the unscattered beam
};
Fluxes fluxes(const Solution& solution, Side side, const Eigen::VectorXd& mu, ThreadPool& pool);

/// Fluxes for beams from all directions of an assembly, multiplied by scale: relative to the incident flux at targets,
/// with one factor of scale at nodes.
Fluxes fluxes_on(const Assembly& assembly, Side side);

/// Hemispherical fluxes for uniform diffuse light.
Fluxes diffuse_fluxes(const Solution& solution, Side side, ThreadPool& pool);

}  // namespace lamina
