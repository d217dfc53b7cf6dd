// SPDX-License-Identifier: GPL-3.0-or-later
// Guiding tables for isotropic scattering, where the two directions at a vertex are independent of each other.
#pragma once
#include <vector>

#include "guided/guide_heights.hpp"
#include "matter/graded_medium.hpp"
#include "numeric/rng.hpp"

namespace lamina {

/// Guiding tables for the walk of the scattering equation with isotropic scattering. There
///   k + kS + Sk + SkS = albedo X(t, mu) X(t, mu0),  X(t, mu) = 1 + 1/2 int S(t; mu', mu) dmu' / mu',
/// so that the two sides of a vertex are independent. The tables hold X, and the density of mu' in proportion to
/// S(t; mu', mu) / mu'.
class IsotropicGuide {
 public:
  explicit IsotropicGuide(const GradedMedium& medium);

  const GuideHeights& heights() const { return heights_; }

  /// The place of a cosine in the tables, which are uniform in its square root.
  struct Place {
    std::size_t cell;
    double fraction;
  };
  static Place place(double mu);

  /// X at the guide's heights.
  GuideHeights::Column escape(const Place& place) const {
    const auto fraction = static_cast<float>(place.fraction);
    return escape_[place.cell] + fraction * (escape_[place.cell + 1] - escape_[place.cell]);
  }
  /// The albedo at the guide's heights.
  const GuideHeights::Column& albedo() const { return albedo_; }

  struct Direction {
    double mu;
    double density;  ///< over the cosine
  };
  /// Draws a direction for a side at `place`, in the cell of heights j at the fraction `up` of the cell.
  Direction draw(std::size_t j, double up, const Place& place, Rng& rng) const;

 private:
  static constexpr std::size_t kCells = 24;  // of the square root of the cosine; walks are unbiased for any number
  static constexpr std::size_t kPoints = kCells + 1;

  const double* row(std::size_t j, std::size_t point) const { return &density_[(j * kPoints + point) * kPoints]; }
  const double* cumulative(std::size_t j, std::size_t point) const {
    return &cumulative_[(j * kPoints + point) * kPoints];
  }

  GuideHeights heights_;
  std::vector<GuideHeights::Column> escape_;  // [point]
  GuideHeights::Column albedo_;
  std::vector<double> density_;     // [height, point, point of the drawn cosine], over the square root
  std::vector<double> cumulative_;  // its integral
};

}  // namespace lamina
