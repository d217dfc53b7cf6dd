// SPDX-License-Identifier: GPL-3.0-or-later
// A walk of the integral scattering equation without guiding.
#pragma once
#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// The BRDF of a slab by the integral scattering equation. Heights are sampled from the exponential, terms with
/// probabilities that depend on the thickness alone, and directions from the phase function. Unbiased, but the variance
/// grows without bound with the depth of the tree. For comparison with the guided walks.
class PlainScatteringWalk final : public Walk {
 public:
  PlainScatteringWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi);

  double sample(Rng& rng, std::uint64_t& events) const override;

 private:
  GradedMedium medium_;
  double mu_o_;
  double mu_i_;
  double dphi_;
};

}  // namespace lamina
