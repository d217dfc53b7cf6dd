// SPDX-License-Identifier: GPL-3.0-or-later
// One azimuth order of a phase function between directions.
#pragma once
#include <Eigen/Core>
#include <utility>

#include "matter/medium.hpp"

namespace lamina {

/// One azimuth order of the phase function between directions: sum over l of (2l+1) chi_l P_l^m P_l^m, for directions
/// in opposite hemispheres of travel (reflect) or in the same one (transmit). Of flakes see FlakeKernel.
struct PhaseKernel {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;

  PhaseKernel(Eigen::MatrixXd back, Eigen::MatrixXd on) : reflect(std::move(back)), transmit(std::move(on)) {}
  PhaseKernel(const TruncatedMedium& medium, int order, const Eigen::VectorXd& mu);
};

/// (2l+1) chi_l of a medium's moments from `order` on.
Eigen::VectorXd phase_weights(const TruncatedMedium& medium, int order);

}  // namespace lamina
