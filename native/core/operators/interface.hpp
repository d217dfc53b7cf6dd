// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering function of a smooth boundary.
#pragma once
#include "operators/directions.hpp"
#include "operators/scattering_function.hpp"

namespace lamina {

/// A smooth boundary: specular reflection and refraction only, no kernels. Directions that exist on one side only are
/// totally reflected.
ScatteringFunction smooth_interface(const Directions& above, const Directions& below);

}  // namespace lamina
