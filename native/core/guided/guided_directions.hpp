// SPDX-License-Identifier: GPL-3.0-or-later
// Directions of the next rays of a guided walk, chosen among candidates by a guide.
#pragma once
#include <cstddef>

#include "guided/scattering_guide.hpp"
#include "matter/graded_medium.hpp"
#include "numeric/rng.hpp"
#include "walks/slab_ray.hpp"

namespace lamina {

/// A vertex of a guided walk.
struct GuidedVertex {
  double t;
  std::size_t cell;  ///< cell of the guide's heights
  double up;         ///< fraction of the cell below the vertex

  /// The value of a table's column here, linear between the heights.
  double at(const GuideHeights::Column& column) const {
    const auto low = static_cast<double>(column[static_cast<Eigen::Index>(cell)]);
    const auto high = static_cast<double>(column[static_cast<Eigen::Index>(cell + 1)]);
    return low + up * (high - low);
  }
};

/// Samples the directions in which a walk of the scattering equation goes on from a vertex: resampled importance
/// sampling (Talbot 2005) by the guide's tables, with the candidates on a randomly shifted lattice.
class GuidedDirections {
 public:
  static constexpr int kMostCandidates = 32;

  /// `candidates` for one side: 8, 16 or 32; throws std::invalid_argument for other numbers. The guide must outlive
  /// this object.
  GuidedDirections(const ScatteringGuide& guide, int candidates);

  /// A sample for k S.
  struct Step {
    SlabRay ray;
    double weight;  ///< k / mu' over the density of the choice; 0: no light
    double value;   ///< S~ for the direction
  };
  /// Resamples a direction for the side of `from` in proportion to k S~ / mu'. Candidates come from k around `from` and
  /// from the tables' S / mu'.
  Step one_side(const GuidedVertex& vertex, const LocalScattering& scattering, const SlabRay& from,
                const SlabRay& other, Rng& rng) const;

  /// A sample for S k S: p goes with a, q with b.
  struct Pair {
    SlabRay p;
    SlabRay q;
    double weight = 0.0;  ///< k / (mu' mu'') over the density of the choice; 0: no light
    double value_p = 0.0;
    double value_q = 0.0;
  };
  /// Resamples directions for both sides together, from all pairs of candidates.
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
