// SPDX-License-Identifier: GPL-3.0-or-later
// A guided walk of the integral scattering equation that estimates only what its tables miss.
#pragma once
#include <memory>

#include "guided/first_vertex.hpp"
#include "guided/guided_directions.hpp"
#include "guided/scattering_guide.hpp"
#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// The BRDF of a homogeneous slab by an unbiased walk of the integral scattering equation that estimates only what
/// tables do not know. Of each S it meets,
///   S = S1 + R,  R = int exp(-(1/mu + 1/mu0)(tau - t)) (kS + Sk + SkS) dt,
/// single scattering S1 is exact and R is taken as
///   R~ + (R' - R~) / q with probability q, else R~,
/// where R~ is what the guide's tables say and R' one vertex more, whose S are again such estimates: whatever R~ is,
/// the mean is R. q is what the walk's weight times R~ is worth against the whole, so that branches of little worth
/// end early and heavy ones do not. The first vertex, between directions that never change, has tables of its own.
class ResidualWalk final : public Walk {
 public:
  /// `candidates` for each direction after the first: 8, 16 or 32. The guide, of the same medium, may be shared.
  /// Throws std::invalid_argument for other numbers, for media that vary with depth, and for those over a surface.
  ResidualWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
               std::shared_ptr<const ScatteringGuide> guide);

  double sample(Rng& rng, std::uint64_t& events) const override;

 private:
  struct Branch;

  Branch branch(const GuidedVertex& vertex, const SlabRay& a, const SlabRay& b, double value) const;
  double estimate(Branch branch, double worth, Rng& rng, std::uint64_t& events) const;

  GradedMedium medium_;
  std::shared_ptr<const ScatteringGuide> guide_;
  SlabRay view_;
  SlabRay light_;
  GuidedDirections directions_;
  LocalScattering scattering_;
  FirstVertex root_;
  double once_;                    ///< the BRDF's single scattering
  double scale_;                   ///< from S to the BRDF
  ScatteringGuide::Column floor_;  ///< what the terms are taken for at least
};

}  // namespace lamina
