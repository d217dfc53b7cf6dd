// SPDX-License-Identifier: GPL-3.0-or-later
// The number of moments of a phase function that light needs behind a rough boundary.
#pragma once
#include <cstddef>

#include "solve/solution.hpp"

namespace lamina {

/// The section between rough boundaries in which a layer lies.
std::size_t section_of(const Solution& solution, std::size_t layer);

/// The number of moments that represent a medium's phase function, blurred by the narrowest lobe of the rough
/// boundaries next to the medium, within the relative error `tolerance` of the light that the medium scatters once. The
/// stack has rough boundaries.
int moments_behind_lobes(const Solution& solution, const Solution::Scatterer& scatterer, double tolerance);

}  // namespace lamina
