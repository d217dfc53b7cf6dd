// SPDX-License-Identifier: GPL-3.0-or-later
// Sampling probabilities of the terms of the scattering equation.
#pragma once
#include "matter/graded_medium.hpp"

namespace lamina {

/// Probabilities with which the walk of the scattering equation samples each term, from an estimate of the size of the
/// terms. The walk is unbiased for any positive probabilities; good estimates reduce its variance.
///
/// The estimate is for a half-space whose phase function is a forward peak, with the share g of the scattering, plus an
/// isotropic part. Scattering in the peak does not change S: it contributes the share w = albedo g of S, divided
/// between a and b in proportion to the cosine of the other direction. The rest is isotropic scattering k0 of albedo (1
/// - g), where the terms of (1/mu_a + 1/mu_b) S are k, k0 x_b, k0 x_a and k0 x_a x_b.
class TermGuide {
 public:
  explicit TermGuide(const GradedMedium& medium);

  /// Probabilities of the terms with a factor S on the side of a (kS), of b (Sk), and on both sides (SkS).
  struct Shares {
    double on_a;
    double on_b;
    double on_both;

    double none() const { return 1.0 - on_a - on_b - on_both; }
  };
  /// For an optical depth and directions of cosines mu_a and mu_b, where k has the value `once`.
  Shares terms(double mu_a, double mu_b, double depth, double once, double albedo) const;

  /// Probability of the term of the surface below the media. `from_ground` is (1/mu_a + 1/mu_b) S of this surface
  /// alone, seen from the optical depth.
  double ground(double mu_a, double mu_b, double depth, double from_ground) const;

  /// Probability that light on its way down is first reflected by the part below a depth, and then scattered at the
  /// depth.
  double before(double mu, double depth, double albedo) const;

 private:
  /// x: light that the part below a depth returns to be scattered again, relative to light that is scattered
  /// immediately. For an isotropic half-space x is H(mu) - 1, with Chandrasekhar's H in the approximation of Hapke
  /// (1981).
  double returned(double mu, double depth, double albedo) const;

  const GradedMedium& medium_;
  double peak_;  ///< g, or 0 if most light is scattered backwards
};

}  // namespace lamina
