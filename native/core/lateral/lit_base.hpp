// SPDX-License-Identifier: GPL-3.0-or-later
// Light of a pencil beam that a diffuse base reflects, on its straight ways to the surface and back.
#pragma once
#include <vector>

#include "lateral/azimuth_rule.hpp"
#include "operators/directions.hpp"

namespace lamina {

/// The point of a Lambert base that a beam along the normal lights. Its light crosses media without scattering, leaves
/// through smooth boundaries, or returns to the base from one of them and is reflected again. In a discretised stack
/// this light travels in discrete directions and leaves in sharp rings; in truth its flux density is smooth. The
/// difference of `at` and `discretised` corrects the discretisation.
class LitBase {
 public:
  /// One medium, or the smooth boundary above it, on the way from the base to the surface.
  struct Part {
    double ior = 1.0;         ///< refractive index of the medium, or above the boundary
    double thickness = 0.0;   ///< of a medium, mm; 0 for a boundary
    double extinction = 0.0;  ///< of a medium, 1/mm
  };
  /// `beam`: unscattered flux of the beam at the base. `parts`: from the base upwards. `directions`: above the base.
  LitBase(const Directions& directions, double beam, double reflectance, std::vector<Part> parts);

  /// The flux in the discretised stack at the lateral frequency q, 1/mm.
  double discretised(double q, const AzimuthRule& azimuths) const;
  /// The same with fine quadratures.
  double at(double q) const;

 private:
  struct Share {
    double flux;
    double aside;  ///< lateral displacement, mm
  };
  /// What becomes of the light of one direction.
  struct Ray {
    Share leaving{0.0, 0.0};
    std::vector<Share> returning;  ///< by boundary
  };
  Ray ray(double mu) const;
  double aside(double mu) const;
  /// Flux that leaves, if the base sends and receives these shares of its light at a frequency.
  double exchanged(double leaving, double returning) const;

  double ior_;
  double beam_;
  double reflectance_;
  std::vector<Part> parts_;
  std::vector<double> critical_;  // ascending cosines above the base from 0 to 1 between which all functions are smooth
  struct Discrete {
    double weight;
    Ray ray;
  };
  std::vector<Discrete> discrete_;
};

}  // namespace lamina
