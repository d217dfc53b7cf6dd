// SPDX-License-Identifier: GPL-3.0-or-later
// Thin films between two media, on a metal, or on both faces of a platelet, whose reflections interfere.
#pragma once
#include <complex>
#include <cstddef>
#include <vector>

#include "numeric/chebyshev_panels.hpp"

namespace lamina {

/// Thin films on one boundary: coherent within the films, for unpolarised light. The transfer matrix gives the
/// reflectance from both sides and the transmittance of each wavelength, and a channel is a weighted sum of them.
/// Both are tabulated by cosine as piecewise Chebyshev polynomials, to 1e-12, because walks and facets ask for millions
/// of values. Method: Macleod, Thin-Film Optical Filters, 2.4; here with refractive indices n + ik.
class Film {
 public:
  enum class Side { kAbove, kBelow };
  /// What lies below the films. A platelet is clear, has the same films on its other face and the medium above beyond
  /// them; it is too thick, or too uneven, for interference of light from both faces.
  enum class Below { kMedium, kMetal, kPlatelet };
  /// One film: its index at a wavelength, and its thickness in wavelengths.
  struct Sheet {
    std::complex<double> ior;
    double thickness;
  };
  /// A wavelength of the channel: its weight, which may be negative, the index below, and the films, outermost first.
  struct Wave {
    double weight;
    std::complex<double> ior_below;
    std::vector<Sheet> sheets;
  };

  /// Of films between two media, the index below is the same in all waves.
  Film(double ior_above, Below below, std::vector<Wave> waves);

  /// The reflectance for light at this cosine on this side, also beyond the critical angle. Weights of both signs can
  /// give values outside [0, 1], colours that no display shows; these are clipped.
  double reflectance(double mu, Side side) const;
  /// The share of the power that passes from this side to the other. It is the same along the path back.
  double transmittance(double mu, Side side) const;
  /// The reflectance from above for uniform diffuse light.
  double mean_reflectance() const;
  bool is_opaque() const { return below_ == Below::kMetal; }
  /// True if no light is absorbed.
  bool conserves() const { return lossless_; }
  /// All parameters: equal films have equal keys.
  const std::vector<double>& key() const { return key_; }

 private:
  using Table = ChebyshevPanels<3>;
  using Values = Table::Values;  // reflectance from above, from below, transmittance

  double ior_of(Side side) const { return side == Side::kAbove ? ior_above_ : ior_below_; }
  struct Normals;
  /// Sums over wavelengths. Beyond the critical angle, only the reflectance on the denser side has a meaning.
  Values sums(const Normals& normals) const;

  double ior_above_;
  double ior_below_;  // where light arrives that passes: that above for a metal or a platelet
  Below below_;
  bool lossless_;  // without absorption
  std::vector<Wave> waves_;
  std::vector<double> key_;
  Table passing_;  // by the cosine on the side of the smaller index
  Table total_;    // beyond the critical angle: by the angle with the sine that is proportional to the decay
};

}  // namespace lamina
