// SPDX-License-Identifier: GPL-3.0-or-later
// A linear map of radiance between directions: a smooth kernel and a delta part.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>

namespace lamina {

/// A linear map of radiance between directions: a smooth kernel plus a diagonal delta part (light that keeps its
/// direction, or its mirror direction). Integrals run over the first `nodes` directions only. The rows and columns
/// after them are targets (see Directions).
///
/// Targets may be of two kinds, the first `views` of them views and the others lights. Then of the blocks between
/// targets only those between the two kinds are computed; the others are never written or read.
struct DirectionOperator {
  Eigen::MatrixXd kernel;
  Eigen::VectorXd delta;
  Eigen::Index nodes = 0;
  Eigen::Index views = kAllTargets;

  static constexpr Eigen::Index kAllTargets = -1;

  static DirectionOperator zero(Eigen::Index size, Eigen::Index nodes, Eigen::Index views = kAllTargets) {
    return {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), nodes, views};
  }

  /// Calls body(row, column, rows, columns) for each block that is computed, the block of the nodes' rows first.
  template <typename Body>
  void each_block(const Body& body) const {
    each_block(delta.size(), nodes, views, body);
  }
  template <typename Body>
  static void each_block(Eigen::Index size, Eigen::Index nodes, Eigen::Index views, const Body& body) {
    const Eigen::Index targets = size - nodes;
    body(Eigen::Index{0}, Eigen::Index{0}, nodes, size);
    if (targets > 0) {
      body(nodes, Eigen::Index{0}, targets, nodes);
      if (views == kAllTargets) {
        body(nodes, nodes, targets, targets);
      } else {
        body(nodes, nodes + views, views, targets - views);
        body(nodes + views, nodes, targets - views, views);
      }
    }
  }

  DirectionOperator transposed() const {
    DirectionOperator turned{Eigen::MatrixXd(kernel.cols(), kernel.rows()), delta, nodes, views};
    each_block([&](auto row, auto column, auto rows, auto columns) {
      turned.kernel.block(row, column, rows, columns) = kernel.block(column, row, columns, rows).transpose();
    });
    return turned;
  }
};

inline DirectionOperator operator+(DirectionOperator a, const DirectionOperator& b) {
  a.each_block([&](auto row, auto column, auto rows, auto columns) {
    a.kernel.block(row, column, rows, columns) += b.kernel.block(row, column, rows, columns);
  });
  a.delta += b.delta;
  return a;
}

/// Applies b, then a.
inline DirectionOperator operator*(const DirectionOperator& a, const DirectionOperator& b) {
  DirectionOperator product{Eigen::MatrixXd(a.kernel.rows(), a.kernel.cols()), a.delta.cwiseProduct(b.delta), a.nodes,
                            a.views};
  const bool a_direct = (a.delta.array() != 0.0).any();
  const bool b_direct = (b.delta.array() != 0.0).any();
  product.each_block([&](auto row, auto column, auto rows, auto columns) {
    auto block = product.kernel.block(row, column, rows, columns);
    block.noalias() = a.kernel.block(row, 0, rows, a.nodes) * b.kernel.block(0, column, a.nodes, columns);
    if (a_direct) {
      block += a.delta.segment(row, rows).asDiagonal() * b.kernel.block(row, column, rows, columns);
    }
    if (b_direct) {
      block += a.kernel.block(row, column, rows, columns) * b.delta.segment(column, columns).asDiagonal();
    }
  });
  return product;
}

/// (1 - a)^-1 = 1 + a + a a + ...: the sum of all orders of reflection.
inline DirectionOperator resolvent(const DirectionOperator& a) {
  const Eigen::Index nodes = a.nodes;
  // Light that is trapped between two totally reflecting mirrors can never have entered.
  DirectionOperator result{Eigen::MatrixXd(a.kernel.rows(), a.kernel.cols()),
                           (a.delta.array() < 1.0).select((1.0 - a.delta.array()).inverse(), 1.0), nodes, a.views};
  Eigen::MatrixXd system = -a.kernel.topLeftCorner(nodes, nodes);
  system.diagonal() += result.delta.head(nodes).cwiseInverse();
  result.kernel.topRows(nodes) =
      system.partialPivLu().solve((a.kernel.topRows(nodes) * result.delta.asDiagonal()).eval());
  a.each_block([&](auto row, auto column, auto rows, auto columns) {
    if (row >= nodes) {
      auto block = result.kernel.block(row, column, rows, columns);
      block = a.kernel.block(row, column, rows, columns) * result.delta.segment(column, columns).asDiagonal();
      block += a.kernel.block(row, 0, rows, nodes) * result.kernel.block(0, column, nodes, columns);
      block = result.delta.segment(row, rows).asDiagonal() * block;
    }
  });
  return result;
}

}  // namespace lamina
