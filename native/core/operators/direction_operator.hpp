// SPDX-License-Identifier: GPL-3.0-or-later
// A linear map of radiance between directions: a smooth kernel and a delta part.
#pragma once
#include <Eigen/Core>

namespace lamina {

/// A linear map of radiance between directions: a smooth kernel plus a diagonal delta part (light that keeps its
/// direction, or its mirror direction). Integrals run over the first `nodes` directions only. The rows and columns
/// after them are targets (see Directions).
///
/// Targets may be of two kinds: the first `views` of them are views, the others lights. Of the blocks between targets,
/// only those between the two kinds are then computed; the others are never written or read.
struct DirectionOperator {
  Eigen::MatrixXd kernel;
  Eigen::VectorXd delta;
  Eigen::Index nodes = 0;
  Eigen::Index views = kAllTargets;

  static constexpr Eigen::Index kAllTargets = -1;

  static DirectionOperator zero(Eigen::Index size, Eigen::Index nodes, Eigen::Index views = kAllTargets);

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

  DirectionOperator transposed() const;
};

DirectionOperator operator+(DirectionOperator a, const DirectionOperator& b);

/// Applies b, then a.
DirectionOperator operator*(const DirectionOperator& a, const DirectionOperator& b);

/// (1 - a)^-1 = 1 + a + a a + ...: the sum of all orders of reflection.
DirectionOperator resolvent(const DirectionOperator& a);

}  // namespace lamina
