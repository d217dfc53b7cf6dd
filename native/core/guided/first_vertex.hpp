// SPDX-License-Identifier: GPL-3.0-or-later
// Tables for the first vertex of a guided walk.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "guided/scattering_guide.hpp"
#include "matter/graded_medium.hpp"
#include "numeric/rng.hpp"

namespace lamina {

/// The first vertex of a walk of the scattering equation in a homogeneous slab. Its two directions are the same for all
/// samples, so tables give the terms kS, Sk and SkS nearly exactly: their sums at each height and, for kS and Sk, the
/// distribution of directions. Directions are tabulated in rectangles of the phase function's two uniform numbers,
/// where k is constant even for a sharp peak. The rectangles are small in angle too, so they resolve S.
class FirstVertex {
 public:
  FirstVertex(const GradedMedium& medium, const ScatteringGuide& guide, const SlabRay& a, const SlabRay& b);

  enum class Term { kOfA, kOfB, kBoth, kNone };
  struct Choice {
    Term term;
    double t;
    std::size_t cell;
    double up;      ///< fraction of the cell below the vertex
    double weight;  ///< one over the probability and density of the choice
    SlabRay ray;    ///< the direction after scattering, for kOfA and kOfB; below the horizon there is no light
  };
  /// For kOfA and kOfB the weight includes k / mu'; for kBoth it does not include S k S.
  Choice draw(Rng& rng) const;

  /// The tables' value of R.
  double rest() const { return total_; }

 private:
  static constexpr std::size_t kRows = 48;   // rows of the uniform number for the cosine
  static constexpr std::size_t kTurns = 48;  // columns of the uniform number for the azimuth
  static constexpr std::size_t kSquares = kRows * kTurns;
  struct Side {
    SlabRay from;
    std::vector<float> value;          // [height, square]: S~ / mu'
    std::vector<float> keep;           // [height, square]: for Walker's alias method
    std::vector<std::uint16_t> alias;  // [height, square]
    ScatteringGuide::Column mean;
  };
  void divide();
  void tabulate(Side& side, const ScatteringGuide& guide, const SlabRay& other);
  SlabRay direction(const Side& side, double row, double turn) const;

  GuideHeights heights_;
  LocalScattering scattering_;
  std::array<double, kRows + 1> rows_;  ///< the ends of the rows
  double slope_;                        ///< 1 / mu + 1 / mu0
  std::array<Side, 2> sides_;
  ScatteringGuide::Column both_;
  ScatteringGuide::Column source_;
  ScatteringGuide::Column mass_;
  double total_ = 0.0;
};

}  // namespace lamina
