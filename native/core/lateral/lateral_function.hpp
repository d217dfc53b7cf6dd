// SPDX-License-Identifier: GPL-3.0-or-later
// The reflection and transmission of a layer at one lateral frequency.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "lateral/azimuth_rule.hpp"
#include "operators/directions.hpp"

namespace lamina {

/// Rows of operators at one lateral frequency: all nodes of the stack for each azimuth, then the beam at its azimuths.
/// The beam is a target (see Directions): columns lead from the beam to the nodes, but no row leads from nodes to the
/// beam.
struct LateralRows {
  const AzimuthRule& azimuths;       ///< of the nodes
  const AzimuthRule& beam_azimuths;  ///< of the beam; one azimuth for a beam along the normal
  Eigen::Index nodes;                ///< of the stack, live or not

  Eigen::Index beam() const { return nodes * azimuths.count; }
  Eigen::Index size() const { return beam() + beam_azimuths.count; }
};

/// The scattering function of a layer at one lateral frequency. Delta parts of nodes are on the diagonals.
struct LateralFunction {
  Eigen::MatrixXd reflect_above;
  Eigen::MatrixXd down;
  Eigen::MatrixXd reflect_below;
  Eigen::MatrixXd up;
};

/// Converts an operator from azimuth orders, each a matrix over the nodes and one target in the symmetric scaling of
/// Directions, to azimuth nodes.
Eigen::MatrixXd from_orders(const std::vector<Eigen::MatrixXd>& orders, const LateralRows& rows);

/// The operator of a delta part, given by nodes and one target, which is the same at all azimuths.
Eigen::MatrixXd from_delta(const Eigen::VectorXd& delta, const LateralRows& rows);

}  // namespace lamina
