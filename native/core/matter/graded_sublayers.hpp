// SPDX-License-Identifier: GPL-3.0-or-later
// Homogeneous sublayers that replace a graded medium.
#pragma once
#include <vector>

#include "matter/graded_medium.hpp"
#include "matter/medium.hpp"

namespace lamina {

/// Homogeneous sublayers that replace a graded medium in the deterministic solver, top first.
///
/// A slab's propagator is the ordered exponential of a generator that is linear in the scattering. Over an interval
/// with linear scattering, two exponentials of half the thickness, with the values at 1/6 and 5/6 of the interval, are
/// accurate to fourth order (commutator-free Magnus integrators: Thalhammer 2006; Blanes and Moan 2006). For other
/// profiles the two have the profile's mean and first moment over the interval.
/// Measured: halving the intervals reduces the error 9 to 20 times. The order is reduced by light at grazing incidence,
/// whose radiance changes quickly below the faces.
///
/// Intervals get longer with the distance from the nearer face, since grazing light resolves the profile near a face.
/// `coarseness` is their length relative to that distance. Intervals end at jumps of the profile.
std::vector<Medium> sublayers_of(const GradedMedium& medium, double coarseness);

}  // namespace lamina
