// SPDX-License-Identifier: GPL-3.0-or-later
// The random walk of the integral scattering equation, with positions.
#pragma once
#include <memory>
#include <vector>

#include "lateral_walks/depth_scale.hpp"
#include "lateral_walks/lateral_walk.hpp"
#include "matter/graded_medium.hpp"
#include "matter/stack.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// Estimates the integral scattering equation with positions, for a pencil beam of cosine `mu_i`. The stack is a list
/// of media, homogeneous or graded, above nothing, a black or Lambert surface, or an absorbing half-space.
///
/// S(D; a, b) is the scattering function of everything below the optical depth D. Light enters at D in direction b and
/// leaves in direction a. With s = 1/mu_a + 1/mu_b,
///   S(D; a, b) = int_D^tau exp(-s (D' - D)) (k + kS(D') + S(D')k + S(D')kS(D')) dD', and over a Lambert surface
///   4 mu_a mu_b reflectance exp(-s (tau - D)).
/// Each vertex displaces light by the path down along b and up along a. The layer is laterally homogeneous, so the
/// displacements of all factors of a term add up (Pharr and Hanrahan 2000, with positions).
/// Transmitted light is sampled by its vertices from the top down: T(D) = exp(-(tau - D)/mu_b) +
///   int_D^tau exp(-(D' - D)/mu_b) T(D')(k + kS(D')) dD'/mu_b, where k and S act on flux.
/// `scales`: lengths in millimetres, one per layer. Throws std::invalid_argument for stacks outside this equation.
std::unique_ptr<LateralWalk> make_plane_scattering_walk(const Stack& stack, const std::vector<DepthScale>& scales,
                                                        double mu_i);

/// The same walk without positions: the BRDF of a slab, over nothing or on a Lambert surface, between two directions.
/// Its only guide are closed forms (TermGuide).
std::unique_ptr<Walk> make_slab_scattering_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi);

}  // namespace lamina
