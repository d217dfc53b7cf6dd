// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering function of a smooth boundary.
#pragma once
#include "matter/facet_optics.hpp"
#include "operators/directions.hpp"
#include "operators/scattering_function.hpp"

namespace lamina {

/// A smooth boundary: specular reflection and refraction only, no kernels. Directions that exist on one side only are
/// totally reflected, unless a film absorbs light. `optics`: as light from above meets the boundary.
ScatteringFunction smooth_interface(const Directions& above, const Directions& below, const FacetOptics& optics);

}  // namespace lamina
