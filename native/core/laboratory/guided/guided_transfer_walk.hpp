// SPDX-License-Identifier: GPL-3.0-or-later
// A photon walk in a slab, guided by the adjoint of a coarse solution.
#pragma once
#include <memory>

#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// The BRDF of a slab, over nothing or on a Lambert surface, by a photon walk of the equation of transfer. The walk is
/// guided by a coarse deterministic solution: the importance of a collision, or of an arrival at the surface, to the
/// viewer (AdjointSource). Single scattering is exact, and the first collision is sampled in proportion to its
/// importance. The importance C of a collision is estimated as
///   C~ + (C' - C~) / q with probability q, else C~,
/// where C~ is the table's value. C' comes from several flights, sampled by the phase function from the ray and from
/// the exit direction: the next events along all of them, in closed form in a homogeneous medium, plus the importance
/// at the end of one, resampled by the table. Unbiased for any table.
std::unique_ptr<Walk> make_guided_transfer_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi);

}  // namespace lamina
