// SPDX-License-Identifier: GPL-3.0-or-later
// The light that a smooth boundary between two dielectrics reflects and passes.
#pragma once
#include "matter/facet_optics.hpp"

namespace lamina {

/// Shares of the power along one path through a smooth boundary: reflected above and below, and passed.
struct SmoothBoundary {
  double above = 1.0;
  double below = 1.0;
  double passed = 0.0;

  /// `optics`: as light from above meets the boundary. The cosines are related by Snell's law; 0 where the path does
  /// not exist.
  SmoothBoundary(const FacetOptics& optics, double mu_above, double mu_below) {
    const bool exists = mu_above > 0.0 && mu_below > 0.0;
    if (optics.film) {
      above = mu_above > 0.0 ? optics.reflectance(mu_above) : 1.0;
      below = mu_below > 0.0 ? optics.turned().reflectance(mu_below) : 1.0;
      passed = exists ? optics.transmittance(mu_above) : 0.0;
    } else if (exists) {
      above = below = fresnel(mu_above, mu_below, optics.here, optics.beyond);
      passed = 1.0 - above;
    }
  }
};

}  // namespace lamina
