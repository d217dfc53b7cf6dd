// SPDX-License-Identifier: GPL-3.0-or-later
// A guided walk of the integral scattering equation that estimates only the error of its tables.
#pragma once
#include <memory>

#include "guided/first_vertex.hpp"
#include "guided/guided_directions.hpp"
#include "guided/scattering_guide.hpp"
#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// The BRDF of a homogeneous slab by an unbiased walk of the integral scattering equation that estimates only the
/// error of its tables. Each S is split into
///   S = S1 + R,  R = int exp(-(1/mu + 1/mu0)(tau - t)) (kS + Sk + SkS) dt.
/// Single scattering S1 is exact. R is estimated as
///   R~ + (R' - R~) / q with probability q, else R~,
/// where R~ is the tables' value and R' adds one vertex whose factors S are estimated in the same way. The mean is R
/// for any R~. q is proportional to the walk's weight times R~, so branches of small weight end early. The first vertex
/// has its own tables, since its two directions are the same for all samples.
class ResidualWalk final : public Walk {
 public:
  /// `candidates` for each direction after the first: 8, 16 or 32. The guide, of the same medium, may be shared.
  /// Throws std::invalid_argument for other numbers, for graded media, and for media over a surface.
  ResidualWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
               std::shared_ptr<const ScatteringGuide> guide);

  double sample(Rng& rng, std::uint64_t& events) const override;

 private:
  struct Branch;

  Branch branch(const GuidedVertex& vertex, const SlabRay& a, const SlabRay& b, double value) const;
  double estimate(Branch branch, double importance, Rng& rng, std::uint64_t& events) const;

  GradedMedium medium_;
  std::shared_ptr<const ScatteringGuide> guide_;
  SlabRay view_;
  SlabRay light_;
  GuidedDirections directions_;
  LocalScattering scattering_;
  FirstVertex root_;
  double once_;                    ///< the BRDF's single scattering
  double scale_;                   ///< from S to the BRDF
  ScatteringGuide::Column floor_;  ///< least kS + Sk + SkS
};

}  // namespace lamina
