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
/// guided by coarse tables of S. The height t is sampled in proportion to the tabulated sum of the terms, then one term
/// is sampled. The term k is exact and ends the branch. The other terms continue into S of thinner slabs. Their
/// directions are resampled from several candidates in proportion to the tables (resampled importance sampling, Talbot
/// 2005); the candidates lie on a randomly shifted lattice.
class GuidedWalk final : public Walk {
 public:
  /// `candidates` for each direction: 8, 16 or 32. The guide, of the same medium, may be shared.
  GuidedWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
             std::shared_ptr<const ScatteringGuide> guide);

  double sample(Rng& rng, std::uint64_t& events) const override;

 private:
  struct Branch;
  struct Guidance;

  Guidance guidance(const Branch& branch) const;

  GradedMedium medium_;
  std::shared_ptr<const ScatteringGuide> guide_;
  SlabRay view_;
  SlabRay light_;
  GuidedDirections directions_;
};

}  // namespace lamina
