// SPDX-License-Identifier: GPL-3.0-or-later
// A guided walk of the integral scattering equation for isotropic scattering.
#pragma once
#include "guided/isotropic_guide.hpp"
#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// The BRDF of a slab with isotropic scattering by an unbiased guided walk of the integral scattering equation
///   S(tau) = int exp(-(1/mu + 1/mu0)(tau - t)) albedo(t) X(t, mu) X(t, mu0) dt.
class IsotropicWalk final : public Walk {
 public:
  /// Throws std::invalid_argument if the medium is not isotropic.
  IsotropicWalk(const GradedMedium& medium, double mu_o, double mu_i);

  double sample(Rng& rng, std::uint64_t& events) const override;

 private:
  GradedMedium medium_;
  IsotropicGuide guide_;
  double mu_o_;
  double mu_i_;
};

}  // namespace lamina
