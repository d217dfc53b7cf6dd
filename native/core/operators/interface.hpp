// SPDX-License-Identifier: GPL-3.0-or-later
// Fresnel's equations and the scattering function of a smooth boundary.
#pragma once
#include "operators/directions.hpp"
#include "operators/scattering_function.hpp"

namespace lamina {

/// Fresnel reflectance of a smooth boundary between two dielectrics for unpolarised light. The cosines are related by
/// Snell's law. 1 beyond the critical angle.
inline double fresnel(double mu_above, double mu_below, double ior_above, double ior_below) {
  const double s = (ior_above * mu_above - ior_below * mu_below) / (ior_above * mu_above + ior_below * mu_below);
  const double p = (ior_below * mu_above - ior_above * mu_below) / (ior_below * mu_above + ior_above * mu_below);
  return 0.5 * (s * s + p * p);
}

/// A smooth boundary: specular reflection and refraction only, no kernels. Directions that exist on one side only are
/// totally reflected.
ScatteringFunction smooth_interface(const Directions& above, const Directions& below);

}  // namespace lamina
