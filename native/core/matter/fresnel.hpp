// SPDX-License-Identifier: GPL-3.0-or-later
// Fresnel's equations for the boundary between two dielectrics, for unpolarised light.
#pragma once
#include <cmath>

namespace lamina {

/// The reflectance; the cosines are related by Snell's law.
inline double fresnel(double mu_above, double mu_below, double ior_above, double ior_below) {
  const double s = (ior_above * mu_above - ior_below * mu_below) / (ior_above * mu_above + ior_below * mu_below);
  const double p = (ior_below * mu_above - ior_above * mu_below) / (ior_below * mu_above + ior_above * mu_below);
  return 0.5 * (s * s + p * p);
}

/// The reflectance of a dielectric of relative index `eta` at cosine `c`; 1 beyond the critical angle.
inline double fresnel(double c, double eta) {
  const double square = eta * eta - 1.0 + c * c;
  return square > 0.0 ? fresnel(c, std::sqrt(square) / eta, 1.0, eta) : 1.0;
}

}  // namespace lamina
