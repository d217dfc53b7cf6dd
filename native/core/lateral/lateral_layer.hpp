// SPDX-License-Identifier: GPL-3.0-or-later
// A homogeneous medium with lengths, and its scattering function at a lateral frequency.
#pragma once
#include <cmath>
#include <vector>

#include "lateral/lateral_function.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {

/// A homogeneous medium on the directions of a stack, with what no frequency changes.
///
/// With u and v, the sum and the difference of down- and upwelling radiance, the equation of transfer reads
/// du/dt = -A v, dv/dt = -B u as without a wave, but A and B have the wave's coupling of azimuths in their extinction
/// and are no longer symmetric. Light that enters both faces of a layer alike or oppositely sees
///   R + T = (1 - G) (1 + G)^-1,   G = B f(A B),   R - T = -(1 - H) (1 + H)^-1,   H = f(A B) A,
/// where f(k^2) = tanh(k tau / 2) / k. For a thin layer f is a quotient of polynomials (Pade's approximant), good to
/// rounding; thicker layers follow by doubling. That needs no modes, so neither their complex pairs nor the vanishing
/// rate of conservative media are special.
class LateralMedium {
 public:
  /// `moments` that the directions resolve; `extinction` per millimetre and `thickness` in millimetres.
  LateralMedium(const Medium& medium, int moments, const Directions& directions, double extinction, double thickness);

  const TruncatedMedium& medium() const { return medium_; }
  const PhaseFunction& phase() const { return phase_; }
  /// Of the truncated medium, per millimetre.
  double extinction() const { return extinction_; }
  double thickness() const { return thickness_; }
  /// The optical thickness of the peak that truncation counts as unscattered.
  double truncated_tau() const { return std::isinf(whole_tau_) ? 0.0 : whole_tau_ - medium_.tau; }
  bool scatters() const { return scatters_; }

  /// At the frequency q in radians per millimetre.
  LateralFunction at(double q, const LateralRows& rows) const;
  /// In the limit of high frequencies: only the beam comes through, if it runs along the normal.
  LateralFunction at_infinity(const LateralRows& rows) const;

 private:
  /// Blocks over live nodes and the target.
  struct Transfer {
    Eigen::MatrixXd a;
    Eigen::MatrixXd b;
  };
  Transfer transfer(double q, const LateralRows& rows) const;
  Eigen::MatrixXd passing(double q, const LateralRows& rows) const;
  Eigen::MatrixXd spread(const Eigen::MatrixXd& compact, const LateralRows& rows) const;

  TruncatedMedium medium_;
  PhaseFunction phase_;
  Directions directions_;
  double extinction_;
  double thickness_;
  double whole_tau_;  // before truncation
  bool scatters_;
  Eigen::VectorXd sine_;               // of live nodes, then of the target
  std::vector<Eigen::MatrixXd> even_;  // by order: what A has of scattering, between live nodes and the target
  std::vector<Eigen::MatrixXd> odd_;   // what B has
};

}  // namespace lamina
