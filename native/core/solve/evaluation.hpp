// SPDX-License-Identifier: GPL-3.0-or-later
// BRDF, BTDF and fluxes of a solved stack.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "solve/solution.hpp"

namespace lamina {

class Assembly;
class FacetMeetings;

enum class Side { kTop, kBottom };
enum class Path { kReflect, kTransmit };

/// BRDF or BTDF (1/sr, without deltas) of a solved stack. Light comes in on `side`; cosines in (0, 1] are
/// taken in the medium where each ray runs; dphi = 0 means that light keeps its azimuth.
/// On a product grid: result[(o * mu_i.size() + i) * dphi.size() + p].
std::vector<double> evaluate_grid(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                  const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool);

/// The same for several sides and paths at once: the stack is put together once for all of them.
struct Passage {
  Side side;
  Path path;
};
/// For each passage and azimuth order, the part of pi f between all targets of an assembly that is smooth: without
/// light that a medium scattered once or facets once or twice.
std::vector<std::vector<Eigen::MatrixXd>> smooth_orders(const Assembly& assembly, const FacetMeetings& meetings,
                                                        const std::vector<Passage>& passages, ThreadPool& pool);
std::vector<std::vector<double>> evaluate_grids(const Solution& solution, const std::vector<Passage>& passages,
                                                const Eigen::VectorXd& mu_o, const Eigen::VectorXd& mu_i,
                                                const Eigen::VectorXd& dphi, ThreadPool& pool);

/// For lists of equal length, one value for each triple.
std::vector<double> evaluate_points(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                    const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool);

/// Hemispherical fluxes for a beam from each direction, relative to the incident flux.
struct Fluxes {
  Eigen::VectorXd reflected;    ///< without the mirror image
  Eigen::VectorXd mirrored;     ///< the mirror image of the beam
  Eigen::VectorXd transmitted;  ///< without the unscattered beam
  Eigen::VectorXd direct;       ///< the unscattered beam
};
Fluxes fluxes(const Solution& solution, Side side, const Eigen::VectorXd& mu, ThreadPool& pool);

/// For beams from all directions of an assembly, as powers for unit radiance times scale: at targets relative to
/// the incident flux, at nodes with one factor of scale left.
Fluxes fluxes_on(const Assembly& assembly, Side side);

/// The same for uniform diffuse light.
Fluxes diffuse_fluxes(const Solution& solution, Side side, ThreadPool& pool);

}  // namespace lamina
