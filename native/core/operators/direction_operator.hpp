// SPDX-License-Identifier: GPL-3.0-or-later
// A linear map of radiance between directions: a smooth kernel and a delta part.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>

namespace lamina {

/// A linear map of radiance between directions: a smooth kernel plus a diagonal delta part (light that keeps its
/// direction, or its mirror direction). Integrals run over the first `nodes` directions only. The rows and columns
/// after them are targets (see Directions). An empty kernel is zero.
///
/// Targets may be of two kinds: the first `views` of them are views, the others lights. Of the blocks between targets,
/// only those between the two kinds are then computed. With `to_targets` or `from_targets`, only the rows or columns of
/// targets are computed. The other blocks are never written or read.
struct DirectionOperator {
  Eigen::MatrixXd kernel;
  Eigen::VectorXd delta;
  Eigen::Index nodes = 0;
  Eigen::Index views = kAllTargets;
  bool to_targets = false;
  bool from_targets = false;

  static constexpr Eigen::Index kAllTargets = -1;

  static DirectionOperator zero(Eigen::Index size, Eigen::Index nodes, Eigen::Index views = kAllTargets);

  bool has_kernel() const { return kernel.size() > 0; }

  /// Calls body(row, column, rows, columns) for each block that is computed, the block of the nodes' rows first.
  template <typename Body>
  void each_block(const Body& body) const {
    const Eigen::Index size = delta.size();
    const Eigen::Index targets = size - nodes;
    if (!to_targets) {
      const Eigen::Index first = from_targets ? nodes : 0;
      body(Eigen::Index{0}, first, nodes, size - first);
    }
    if (targets > 0) {
      if (!from_targets) {
        body(nodes, Eigen::Index{0}, targets, nodes);
      }
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
class Resolvent {
 public:
  explicit Resolvent(DirectionOperator a);

  /// Applies b, then the resolvent.
  DirectionOperator operator*(const DirectionOperator& b) const;

 private:
  DirectionOperator a_;
  Eigen::VectorXd delta_;
  Eigen::PartialPivLU<Eigen::MatrixXd> system_;  // of the nodes
};

}  // namespace lamina
