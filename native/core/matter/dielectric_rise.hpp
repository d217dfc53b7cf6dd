// SPDX-License-Identifier: GPL-3.0-or-later
// Fresnel's reflectance of a dielectric, relative to its value at normal incidence.
#pragma once
#include <algorithm>
#include <cmath>

#include "matter/fresnel.hpp"

namespace lamina {

/// F0, the reflectance at normal incidence, of the relative index `eta`.
inline double f0_from_index(double eta) {
  const double root = (eta - 1.0) / (eta + 1.0);
  return root * root;
}

/// The relative index, at least 1, with this reflectance at normal incidence. Cycles limits F0 to .99.
inline double index_from_f0(double f0) {
  const double root = std::sqrt(std::clamp(f0, 0.0, 0.99));
  return (1.0 + root) / (1.0 - root);
}

/// (F - F0) / (1 - F0), in [0, 1].
inline double dielectric_rise(double c, double eta) {
  const double f0 = f0_from_index(eta);
  return std::clamp((fresnel(c, eta) - f0) / (1.0 - f0), 0.0, 1.0);
}

}  // namespace lamina
