// SPDX-License-Identifier: GPL-3.0-or-later
// One layer's scattering of radiance on nodes and functions of the azimuth, in one block of functions.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "oriented/azimuth_blocks.hpp"

namespace lamina {

/// Matrices of an isotropic layer, by azimuth order; empty matrices beyond the orders that it scatters are not allowed.
using OrderMatrices = std::vector<Eigen::MatrixXd>;

/// A linear map between vectors over functions and nodes, in the sparsest form: the same diagonal for all functions, a
/// matrix for each order, or a whole matrix. An operator without a form is zero.
class BlockOperator {
 public:
  BlockOperator() = default;
  /// Specular light; the vector may be shorter than the number of nodes on either side.
  static BlockOperator specular(const Eigen::VectorXd& diagonal, Eigen::Index out, Eigen::Index in);
  /// An isotropic layer in a block of functions.
  static BlockOperator isotropic(std::shared_ptr<const OrderMatrices> orders, std::vector<std::size_t> order_of);
  /// A whole matrix; kept by reference.
  static BlockOperator coupled(const Eigen::MatrixXd& matrix);

  bool is_zero() const { return form_ == Form::kZero; }
  /// The operator, or its transpose, applied to columns; `rows` is the size of the result.
  Eigen::MatrixXd times(const Eigen::MatrixXd& columns, Eigen::Index rows) const { return apply(columns, rows, false); }
  Eigen::MatrixXd transposed_times(const Eigen::MatrixXd& columns, Eigen::Index rows) const {
    return apply(columns, rows, true);
  }
  void add_to(Eigen::MatrixXd& matrix) const;

 private:
  enum class Form { kZero, kSpecular, kIsotropic, kCoupled };
  Eigen::MatrixXd apply(const Eigen::MatrixXd& columns, Eigen::Index rows, bool transposed) const;

  Form form_ = Form::kZero;
  Eigen::VectorXd diagonal_;
  Eigen::Index out_ = 0;  // nodes
  Eigen::Index in_ = 0;
  std::shared_ptr<const OrderMatrices> orders_;
  std::vector<std::size_t> order_of_;  // by function of the block
  const Eigen::MatrixXd* matrix_ = nullptr;
};

/// A layer of a stack; light from below is transmitted by the transpose.
struct BlockLayer {
  BlockOperator reflect_above;
  BlockOperator transmit;
  BlockOperator reflect_below;
};

}  // namespace lamina
