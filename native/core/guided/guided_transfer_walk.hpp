// SPDX-License-Identifier: GPL-3.0-or-later
// A photon walk in a homogeneous slab, guided by the adjoint of a coarse solution.
#pragma once
#include <memory>

#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// The BRDF of a homogeneous slab by a photon walk of the equation of transfer that is guided as the residual walk of
/// the scattering equation is: by the coarse deterministic solution, here what a collision is worth to the viewer
/// (AdjointSource). Single scattering is exact and the first collision is drawn in proportion to its worth. A
/// collision's worth C is taken as
///   C~ + (C' - C~) / q with probability q, else C~,
/// where C~ is what the table says and C' comes from several flights with ends, by the phase function from the ray and
/// from the exit: next event, in closed form, along all of them, and the worth of one end, resampled by the table.
/// Unbiased whatever the table says. Throws std::invalid_argument for media that vary with depth, or over a surface.
std::unique_ptr<Walk> make_guided_transfer_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi);

}  // namespace lamina
