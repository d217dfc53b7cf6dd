// SPDX-License-Identifier: GPL-3.0-or-later
// The reflection of a measured isotropic material, from a table by half vectors.
#pragma once
#include <cstdint>
#include <vector>

#include "matter/microfacet.hpp"

namespace lamina {

/// The BRDF f of an isotropic material by the half vector of both directions (Rusinkiewicz 1998): by its angle h with
/// the normal, the angle d between it and either direction, and c = |cosine| of the azimuth of the directions about
/// it. An exchange of view and light keeps all three, so each table is reciprocal.
///
/// The table holds log((mu_o + mu_i + kOffset) f), in 1/sr, at knots that are dense about the mirror direction
/// and at the horizon: h = kSteepest t^2 with t uniform on [0, 1]; d = e (1 - (1 - s)^2) with s uniform, where e is the
/// angle at which one direction reaches the horizon; c uniform. The factor keeps the values of facets bounded at
/// grazing angles. Between knots log f is interpolated by cubic polynomials.
class MeasuredReflection {
 public:
  static constexpr int kTilts = 64;                   ///< knots in h
  static constexpr int kHalves = 24;                  ///< knots in d
  static constexpr int kTurns = 17;                   ///< knots in c
  static constexpr double kSteepest = 0.997 * 0.997;  ///< largest h, in units of pi / 2
  static constexpr double kOffset = 0.01;

  /// `steps`: values [h][d][c], from 0 for the logarithm `low` to 65535 for `high`. Throws std::invalid_argument for
  /// another size.
  MeasuredReflection(double low, double high, const std::vector<std::uint16_t>& steps);

  /// f in 1/sr between two directions; `along`: cosine between either direction and the half vector.
  double value(double mu_o, double mu_i, double along) const;
  /// As the functions of microfacet.hpp.
  Eigen::ArrayXd values(double mu_o, double mu_i, const Eigen::ArrayXd& cosines) const;
  Eigen::ArrayXXd values(double mu, const FacetPairs& pairs) const;

  /// The width of GGX facets whose lobe is as wide as the narrowest peak of the table; 1 without a peak.
  double alpha() const { return alpha_; }
  /// All parameters, for caches.
  const std::vector<double>& table() const { return table_; }

 private:
  double peak_width(int half) const;

  std::vector<double> table_;
  double alpha_ = 1.0;
};

}  // namespace lamina
