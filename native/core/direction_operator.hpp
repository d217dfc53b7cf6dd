// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>

namespace lamina {

/// A linear map of radiance between directions: a smooth kernel plus a diagonal delta part (light that
/// keeps its direction, or its mirror direction). Integrals run over the first `nodes` directions only;
/// the rows and columns behind them are targets (see Directions) and merely carried along.
struct DirectionOperator {
  Eigen::MatrixXd kernel;
  Eigen::VectorXd delta;
  Eigen::Index nodes = 0;

  static DirectionOperator zero(Eigen::Index size, Eigen::Index nodes) {
    return {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), nodes};
  }

  DirectionOperator transposed() const { return {kernel.transpose(), delta, nodes}; }
};

inline DirectionOperator operator+(const DirectionOperator& a, const DirectionOperator& b) {
  return {a.kernel + b.kernel, a.delta + b.delta, a.nodes};
}

/// First b, then a.
inline DirectionOperator operator*(const DirectionOperator& a, const DirectionOperator& b) {
  DirectionOperator product;
  product.nodes = a.nodes;
  product.kernel.noalias() = a.kernel.leftCols(a.nodes) * b.kernel.topRows(a.nodes);
  product.kernel += a.delta.asDiagonal() * b.kernel;
  product.kernel += a.kernel * b.delta.asDiagonal();
  product.delta = a.delta.cwiseProduct(b.delta);
  return product;
}

/// (1 - a)^-1 = 1 + a + a a + ...: all orders of repetition at once.
inline DirectionOperator resolvent(const DirectionOperator& a) {
  const Eigen::Index nodes = a.nodes;
  const Eigen::Index targets = a.delta.size() - nodes;
  DirectionOperator result;
  result.nodes = nodes;
  // Light that a mirror pair keeps for ever (total reflection on both sides, nothing between) never entered.
  result.delta = (a.delta.array() < 1.0).select((1.0 - a.delta.array()).inverse(), 1.0);
  result.kernel = a.kernel * result.delta.asDiagonal();
  Eigen::MatrixXd system = -a.kernel.topLeftCorner(nodes, nodes);
  system.diagonal() += result.delta.head(nodes).cwiseInverse();
  result.kernel.topRows(nodes) = system.partialPivLu().solve(result.kernel.topRows(nodes).eval());
  if (targets > 0) {
    auto rest = result.kernel.bottomRows(targets);
    rest += a.kernel.bottomLeftCorner(targets, nodes) * result.kernel.topRows(nodes);
    rest = result.delta.tail(targets).asDiagonal() * rest;
  }
  return result;
}

}  // namespace lamina
