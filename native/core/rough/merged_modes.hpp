// SPDX-License-Identifier: GPL-3.0-or-later
// Merges two sums over rays that discretise the same operator in opposite senses.
#pragma once
#include <Eigen/Core>

#include "operators/directions.hpp"

namespace lamina {

/// Polynomials that are orthonormal in flux on each range of a medium's live nodes, as columns, and their degrees. With
/// `factor`, by live node, polynomials times this factor.
struct Modes {
  Eigen::MatrixXd basis;
  Eigen::VectorXi degree;

  Modes(const DirectionSet& set, const Directions& nodes) : Modes(set, nodes, Eigen::VectorXd::Ones(nodes.live)) {}
  Modes(const DirectionSet& set, const Directions& nodes, const Eigen::VectorXd& factor);
};

/// Merges two discretisations of one operator: `one` sums over rays that leave on the side `out`, `other` is its
/// reverse. Sums over rays are least accurate for high polynomials on the side where light leaves. For each pair of
/// polynomials, the result takes the sum whose outgoing polynomial has the lower degree.
Eigen::MatrixXd merged(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other, const Modes& out, const Modes& in);

}  // namespace lamina
