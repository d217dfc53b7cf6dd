// SPDX-License-Identifier: GPL-3.0-or-later
// Directions of the next rays of a guided walk, chosen among candidates by a guide.
#pragma once
#include <cstddef>

#include "guided/scattering_guide.hpp"
#include "matter/graded_medium.hpp"
#include "numeric/rng.hpp"
#include "walks/slab_ray.hpp"

namespace lamina {

/// Where light scatters in a walk that a guide leads.
struct GuidedVertex {
  double t;
  std::size_t cell;  ///< of the guide's heights
  double up;         ///< way up in the cell
};

/// The directions in which a walk of the scattering equation goes on from a vertex, chosen from several candidates by
/// what the guide's tables say light brings from there: resampled importance sampling (Talbot 2005), with the
/// candidates on a randomly shifted lattice.
class GuidedDirections {
 public:
  static constexpr int kMostCandidates = 32;

  /// `candidates` for one side: 8, 16 or 32. Throws std::invalid_argument for other numbers. The guide must outlive
  /// this.
  GuidedDirections(const ScatteringGuide& guide, int candidates);

  /// For k S.
  struct Step {
    SlabRay ray;
    double weight;  ///< k / mu' over the density of the choice; 0: nothing comes
    double value;   ///< S~ there
  };
  /// A direction of the side of `from`, by k around it or from where the tables say S is large, among candidates of
  /// both sorts in proportion to k S~ / mu'.
  Step one_side(const GuidedVertex& vertex, const LocalScattering& scattering, const SlabRay& from,
                const SlabRay& other, Rng& rng) const;

  /// For S k S: p goes with a, q with b.
  struct Pair {
    SlabRay p;
    SlabRay q;
    double weight = 0.0;  ///< k / (mu' mu'') over the density of the choice; 0: nothing comes
    double value_p = 0.0;
    double value_q = 0.0;
  };
  /// Directions of both sides together, from all pairs of candidates.
  Pair both_sides(const GuidedVertex& vertex, const LocalScattering& scattering, const SlabRay& a, const SlabRay& b,
                  Rng& rng) const;

 private:
  template <int kOwn, int kDrawn>
  Step among(const GuidedVertex& vertex, const LocalScattering& scattering, const SlabRay& from, const SlabRay& other,
             Rng& rng) const;

  const ScatteringGuide* guide_;
  int candidates_;
};

}  // namespace lamina
