// SPDX-License-Identifier: GPL-3.0-or-later
// A walk of the integral scattering equation, guided by coarse tables of its solution.
#pragma once
#include <memory>

#include "guided/guided_directions.hpp"
#include "guided/scattering_guide.hpp"
#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// The BRDF of a slab by an unbiased walk of the integral scattering equation
///   S(tau) = int exp(-(1/mu + 1/mu0)(tau - t)) (k + kS(t) + S(t)k + S(t)kS(t)) dt
/// that coarse tables of S guide: the height t is drawn in proportion to what the tables say the terms add there,
/// then one term; k is exact and ends the branch; the others go on into S of thinner slabs, in directions chosen
/// from several candidates by what the tables say light brings from there (resampled importance sampling, Talbot
/// 2005, with the candidates on a randomly shifted lattice).
class GuidedWalk final : public Walk {
 public:
  /// `candidates` for each direction: 8, 16 or 32. The guide, of the same medium, may be shared.
  GuidedWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
             std::shared_ptr<const ScatteringGuide> guide);

  double sample(Rng& rng, std::uint64_t& events) const override;

 private:
  struct Branch;

  GradedMedium medium_;
  std::shared_ptr<const ScatteringGuide> guide_;
  SlabRay view_;
  SlabRay light_;
  GuidedDirections directions_;
};

}  // namespace lamina
