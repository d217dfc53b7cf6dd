// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/direction_operator.hpp"

#include <utility>

namespace lamina {

DirectionOperator DirectionOperator::zero(Eigen::Index size, Eigen::Index nodes, Eigen::Index views) {
  return {Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), nodes, views};
}

DirectionOperator DirectionOperator::transposed() const {
  DirectionOperator turned{
      Eigen::MatrixXd(kernel.cols(), kernel.rows()), delta, nodes, views, from_targets, to_targets};
  if (has_kernel()) {
    turned.each_block([&](auto row, auto column, auto rows, auto columns) {
      turned.kernel.block(row, column, rows, columns) = kernel.block(column, row, columns, rows).transpose();
    });
  }
  return turned;
}

DirectionOperator operator+(DirectionOperator a, const DirectionOperator& b) {
  a.to_targets = a.to_targets || b.to_targets;
  a.from_targets = a.from_targets || b.from_targets;
  a.delta += b.delta;
  if (!a.has_kernel()) {
    a.kernel = b.kernel;
  } else if (b.has_kernel()) {
    a.each_block([&](auto row, auto column, auto rows, auto columns) {
      a.kernel.block(row, column, rows, columns) += b.kernel.block(row, column, rows, columns);
    });
  }
  return a;
}

DirectionOperator operator*(const DirectionOperator& a, const DirectionOperator& b) {
  DirectionOperator product{Eigen::MatrixXd(), a.delta.cwiseProduct(b.delta), a.nodes,
                            a.views,           a.to_targets || b.to_targets,  a.from_targets || b.from_targets};
  const bool smooth = a.has_kernel() && b.has_kernel();
  const bool a_direct = b.has_kernel() && (a.delta.array() != 0.0).any();
  const bool b_direct = a.has_kernel() && (b.delta.array() != 0.0).any();
  if (!smooth && !a_direct && !b_direct) {
    return product;
  }
  product.kernel.resize(a.delta.size(), a.delta.size());
  product.each_block([&](auto row, auto column, auto rows, auto columns) {
    auto block = product.kernel.block(row, column, rows, columns);
    if (smooth) {
      block.noalias() = a.kernel.block(row, 0, rows, a.nodes) * b.kernel.block(0, column, a.nodes, columns);
    } else {
      block.setZero();
    }
    if (a_direct) {
      block += a.delta.segment(row, rows).asDiagonal() * b.kernel.block(row, column, rows, columns);
    }
    if (b_direct) {
      block += a.kernel.block(row, column, rows, columns) * b.delta.segment(column, columns).asDiagonal();
    }
  });
  return product;
}

Resolvent::Resolvent(DirectionOperator a)
    : a_(std::move(a)),
      // Light that is trapped between two totally reflecting mirrors can never have entered.
      delta_((a_.delta.array() < 1.0).select((1.0 - a_.delta.array()).inverse(), 1.0)) {
  if (a_.has_kernel()) {
    Eigen::MatrixXd system = -a_.kernel.topLeftCorner(a_.nodes, a_.nodes);
    system.diagonal() += delta_.head(a_.nodes).cwiseInverse();
    system_.compute(system);
  }
}

DirectionOperator Resolvent::operator*(const DirectionOperator& b) const {
  DirectionOperator result{Eigen::MatrixXd(), delta_.cwiseProduct(b.delta), b.nodes, b.views, b.to_targets,
                           b.from_targets};
  if (!a_.has_kernel() && !b.has_kernel()) {
    return result;
  }
  // x = b + a x, first for the rows of nodes.
  result.kernel.resize(b.delta.size(), b.delta.size());
  result.each_block([&](auto row, auto column, auto rows, auto columns) {
    auto block = result.kernel.block(row, column, rows, columns);
    if (!a_.has_kernel()) {
      block = delta_.segment(row, rows).asDiagonal() * b.kernel.block(row, column, rows, columns);
      return;
    }
    block = a_.kernel.block(row, column, rows, columns) * result.delta.segment(column, columns).asDiagonal();
    if (b.has_kernel()) {
      block += b.kernel.block(row, column, rows, columns);
    }
    if (row < b.nodes) {
      block = system_.solve(block.eval());
    } else {
      block += a_.kernel.block(row, 0, rows, b.nodes) * result.kernel.block(0, column, b.nodes, columns);
      block = delta_.segment(row, rows).asDiagonal() * block;
    }
  });
  return result;
}

}  // namespace lamina
