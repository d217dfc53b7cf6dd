// SPDX-License-Identifier: GPL-3.0-or-later
// The walk of the integral scattering equation, with positions.
#pragma once
#include <memory>
#include <vector>

#include "lateral_walks/depth_scale.hpp"
#include "lateral_walks/lateral_walk.hpp"
#include "matter/stack.hpp"

namespace lamina {

/// The walk of the integral scattering equation that carries positions, for a pencil beam of cosine `mu_i`: media, with
/// profiles or without, over nothing, black, a Lambert surface or a medium without end that absorbs.
///
/// With S(D; a, b) that of all below the optical depth D, b the direction of light that enters at D and a of light that
/// leaves there, and s = 1/mu_a + 1/mu_b:
///   S(D; a, b) = int_D^tau exp(-s (D' - D)) (k + kS(D') + S(D')k + S(D')kS(D')) dD', and over a Lambert surface
///   4 mu_a mu_b reflectance exp(-s (tau - D)).
/// Each vertex displaces light by the way down along b and up along a. As a layer without structure sideways is the
/// same everywhere, displacements of the parts of a term add up (Pharr and Hanrahan 2000, with positions).
/// What is transmitted follows by the vertex nearest to the top: T(D) = exp(-(tau - D)/mu_b) +
///   int_D^tau exp(-(D' - D)/mu_b) T(D')(k + kS(D')) dD'/mu_b, where k and S act on flux.
/// `scales`: lengths in millimetres, one a layer. Throws std::invalid_argument for what the equation does not know.
std::unique_ptr<LateralWalk> make_plane_scattering_walk(const Stack& stack, const std::vector<DepthScale>& scales,
                                                        double mu_i);

}  // namespace lamina
