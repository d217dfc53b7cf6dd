// SPDX-License-Identifier: GPL-3.0-or-later
// Probabilities of the terms of the scattering equation.
#pragma once
#include "matter/graded_medium.hpp"

namespace lamina {

/// How often the walk of the scattering equation takes each term: a guess of how large each is. Any guess above 0
/// leaves the walk unbiased; a good one makes its samples alike.
///
/// The guess takes the phase function for a forward peak, a share g of the scattering, beside an isotropic one, in a
/// layer without end. The peak leaves S as it is: it makes the share w = albedo g of S, on the side of a or b in
/// proportion to the other's cosine. The rest is isotropic scattering k0 of albedo (1 - g), where the terms of
/// (1/mu_a + 1/mu_b) S are k, k0 x_b, k0 x_a and k0 x_a x_b.
class TermGuide {
 public:
  explicit TermGuide(const GradedMedium& medium);

  /// Probabilities of the terms with S below on the side of a (kS), of b (Sk), and on both (SkS).
  struct Shares {
    double on_a;
    double on_b;
    double on_both;

    double none() const { return 1.0 - on_a - on_b - on_both; }
  };
  /// At an optical depth between directions of cosines mu_a and mu_b, where k has the value `once`.
  Shares terms(double mu_a, double mu_b, double depth, double once, double albedo) const;

  /// How often light shall come from the surface below the media: `from_ground` is (1/mu_a + 1/mu_b) S of the surface
  /// alone, as seen at the optical depth.
  double ground(double mu_a, double mu_b, double depth, double from_ground) const;

  /// How often light on its way down shall go on below a depth before it is scattered there.
  double before(double mu, double depth, double albedo) const;

 private:
  /// x: what the part below a depth returns of light of this cosine to be scattered again, over that which is scattered
  /// at once. For isotropic scattering without end it is H(mu) - 1, Chandrasekhar's H in the form of Hapke (1981).
  double returned(double mu, double depth, double albedo) const;

  const GradedMedium& medium_;
  double peak_;  ///< g, or 0 where light is scattered mostly backwards
};

}  // namespace lamina
