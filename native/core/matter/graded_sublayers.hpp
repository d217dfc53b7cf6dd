// SPDX-License-Identifier: GPL-3.0-or-later
// Homogeneous sublayers that stand for a graded medium.
#pragma once
#include <vector>

#include "matter/graded_medium.hpp"
#include "matter/medium.hpp"

namespace lamina {

/// Homogeneous sublayers that stand for a graded medium in the deterministic solver, top first.
///
/// A slab's propagator is the ordered exponential of a generator in which the scattering enters linearly. Over an
/// interval on which it is linear in depth, two exponentials of half the thickness, with what the slab is at 1/6 and at
/// 5/6 of the interval, are right to fourth order (commutator-free Magnus integrators: Thalhammer 2006; Blanes and
/// Moan 2006). For any profile these two have its mean and its first moment over the interval.
/// Measured: half the length of intervals errs 9 to 20 times less; where light comes in at grazing angles the radiance
/// bends sharply below the faces, which takes from the order.
///
/// Intervals grow with the distance from the nearer face, where light at grazing incidence resolves the profile;
/// `coarseness` is the length of one relative to that distance. Where the profile jumps an interval ends.
std::vector<Medium> sublayers_of(const GradedMedium& medium, double coarseness);

}  // namespace lamina
