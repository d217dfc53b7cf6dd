// SPDX-License-Identifier: GPL-3.0-or-later
// A homogeneous medium with lengths, and its scattering function at a lateral frequency.
#pragma once
#include <cmath>
#include <complex>
#include <vector>

#include "lateral/lateral_function.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {

/// A homogeneous medium on the directions of a stack, with all quantities that do not depend on frequency.
///
/// With u and v, the sum and the difference of down- and upwelling radiance, the equation of transfer is du/dt = -A v,
/// dv/dt = -B u as without a wave. But the extinction in A and B couples azimuths, and A and B are no longer symmetric.
/// For light that enters both faces of a layer with equal or opposite signs,
///   R + T = (1 - G) (1 + G)^-1,   G = B f(A B),   R - T = -(1 - H) (1 + H)^-1,   H = f(A B) A,
/// where f(k^2) = tanh(k tau / 2) / k. For a thin layer f is a Pade approximant; thicker layers follow by doubling G
/// and H, which is Newton's iteration for the sign of a matrix. The method needs no modes, so complex pairs of modes
/// and the vanishing rate of conservative media need no special treatment.
class LateralMedium {
 public:
  /// `moments`: number of moments that the directions resolve; `extinction` in 1/mm; `thickness` in mm.
  LateralMedium(const Medium& medium, int moments, const Directions& directions, double extinction, double thickness);

  const TruncatedMedium& medium() const { return medium_; }
  const PhaseFunction& phase() const { return phase_; }
  /// Extinction of the truncated medium, 1/mm.
  double extinction() const { return extinction_; }
  double thickness() const { return thickness_; }
  /// The optical thickness of the peak that truncation counts as unscattered.
  double truncated_tau() const { return std::isinf(whole_tau_) ? 0.0 : whole_tau_ - medium_.tau; }
  bool scatters() const { return scatters_; }

  /// From now on, transmits unscattered light by finer directions than the nodes: `mu`, the cosines of the live ones,
  /// and `carry`, from the live nodes to these (DirectionSet::carry_to). Behind a thickness z, the wave exp(-i q z
  /// tan(theta) cos(phi)) oscillates between the nodes where q z is large.
  void resolve_passing(Eigen::VectorXd mu, Eigen::MatrixXd carry);

  /// The scattering function at the lateral frequency q, 1/mm.
  LateralFunction at(double q, const LateralRows& rows) const;
  /// The limit of high frequencies: only the unscattered beam is transmitted, and only along the normal.
  LateralFunction at_infinity(const LateralRows& rows) const;

 private:
  /// Matrices A and B, with blocks over live nodes and the target.
  struct Transfer {
    Eigen::MatrixXd a;
    Eigen::MatrixXd b;
  };
  Transfer transfer(double q, const LateralRows& rows) const;
  std::complex<double> passed(double q, double mu, std::complex<double> cosine) const;
  Eigen::MatrixXd passing(double q, const LateralRows& rows) const;
  void add_unresolved(double q, const AzimuthRule& azimuths, Eigen::MatrixXd& transmit) const;
  Eigen::MatrixXd spread(const Eigen::MatrixXd& compact, const LateralRows& rows) const;

  TruncatedMedium medium_;
  PhaseFunction phase_;
  Directions directions_;
  double extinction_;
  double thickness_;
  double whole_tau_;  // before truncation
  bool scatters_;
  Eigen::VectorXd sine_;               // sin(theta) of live nodes, then of the target
  std::vector<Eigen::MatrixXd> even_;  // by order: scattering part of A, between live nodes and the target
  std::vector<Eigen::MatrixXd> odd_;   // the same of B
  Eigen::VectorXd fine_mu_;            // finer directions; may be empty
  Eigen::MatrixXd carry_;              // from live nodes to finer directions
};

}  // namespace lamina
