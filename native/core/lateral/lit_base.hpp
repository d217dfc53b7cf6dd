// SPDX-License-Identifier: GPL-3.0-or-later
// Unscattered light of a pencil beam between a diffuse base and the boundaries above the base.
#pragma once
#include <vector>

#include "lateral/azimuth_rule.hpp"
#include "operators/directions.hpp"

namespace lamina {

/// The point of a Lambert base that a beam along the normal illuminates. Light from this point crosses the media
/// without scattering. Smooth boundaries transmit the light or reflect it back to the base, which reflects it again. In
/// a discretised stack the light travels in discrete directions and leaves in sharp rings; the exact flux density is
/// smooth. The difference of `at` and `discretised` corrects the discretisation.
class LitBase {
 public:
  /// One medium, or the smooth boundary above it, on the way from the base to the surface.
  struct Part {
    double ior = 1.0;         ///< refractive index of the medium, or above the boundary
    double thickness = 0.0;   ///< of a medium, mm; 0 for a boundary
    double extinction = 0.0;  ///< of a medium, 1/mm
  };
  /// `beam`: unscattered flux of the beam at the base. `parts`: from the base upwards. `directions`: the discrete
  /// directions above the base.
  LitBase(const Directions& directions, double beam, double reflectance, std::vector<Part> parts);

  /// The flux in the discretised stack at the lateral frequency q, 1/mm.
  double discretised(double q, const AzimuthRule& azimuths) const;
  /// The flux at the lateral frequency q, 1/mm, by fine quadratures over the exact directions.
  double at(double q) const;

 private:
  struct Share {
    double flux;
    double aside;  ///< lateral displacement, mm
  };
  /// The shares of light in one direction that leave, and that return to the base.
  struct Ray {
    Share leaving{0.0, 0.0};
    std::vector<Share> returning;  ///< one entry per boundary
  };
  Ray ray(double mu) const;
  double aside(double mu) const;
  /// The flux that leaves after any number of reflections, at one frequency. Of the light from the base, `leaving` is
  /// the share that leaves, and `returning` the share that returns to the base.
  double exchanged(double leaving, double returning) const;

  double ior_;
  double beam_;
  double reflectance_;
  std::vector<Part> parts_;
  std::vector<double> critical_;  // cosines above the base, ascending from 0 to 1; integrands are smooth in between
  struct Discrete {
    double weight;
    Ray ray;
  };
  std::vector<Discrete> discrete_;
};

}  // namespace lamina
