// SPDX-License-Identifier: GPL-3.0-or-later
// The differential form of the scattering equation, integrated over depth; an independent method for tests.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "matter/graded_medium.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// The discretisation of the differential form.
struct OdeSettings {
  int nodes = 32;           ///< Gauss-Legendre nodes in (0, 1); must resolve the phase functions' peaks
  double tolerance = 1e-8;  ///< largest error of a step, relative to the largest S (at least to 1)
};

/// Solves a slab by the differential form of the scattering equation, on quadrature nodes and by azimuth orders:
///   dS/dt = -(1/mu + 1/mu0) S + k + kS + Sk + SkS,      S = 4 mu mu0 rho where t = 0, the bottom,
/// and for light that is transmitted downwards, without the direct beam E = exp(-t/mu),
///   dT/dt = -T/mu0 + (E + T)(k + kS),
/// where rho is the reflectance of the surface below. The equations are integrated upwards through any profile, without
/// adding and without eigenvectors, independently of the solver.
class OdeSolution {
 public:
  /// Throws std::invalid_argument if the nodes do not resolve a phase function's peak.
  OdeSolution(const GradedMedium& medium, const OdeSettings& settings, const Eigen::VectorXd& targets,
              ThreadPool& pool);

  /// BRDF and BTDF in 1/sr for light from above, between targets (by index); dphi = 0: light keeps its azimuth.
  double brdf(Eigen::Index out, Eigen::Index in, double dphi) const { return sum(true, out, in, dphi); }
  double btdf(Eigen::Index out, Eigen::Index in, double dphi) const { return sum(false, out, in, dphi); }
  /// Shares of the flux of a beam from each target: reflected, and transmitted with scattering.
  Eigen::VectorXd reflectance() const { return flux(true); }
  Eigen::VectorXd transmittance() const { return flux(false); }
  int orders() const { return static_cast<int>(moments_.size()); }
  int steps() const { return steps_; }  ///< steps taken for order 0

 private:
  double sum(bool reflect, Eigen::Index out, Eigen::Index in, double dphi) const;
  Eigen::VectorXd flux(bool reflect) const;

  Eigen::Index nodes_;
  Eigen::VectorXd mu_;  // nodes, then targets
  Eigen::VectorXd weight_;
  std::vector<Eigen::ArrayXXd> moments_;  // by order: S above T; column: incident direction
  int steps_ = 0;
};

}  // namespace lamina
