// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/block_operator.hpp"

#include <algorithm>
#include <utility>

namespace lamina {

using Eigen::Index;
using Eigen::MatrixXd;

BlockOperator BlockOperator::specular(const Eigen::VectorXd& diagonal, Index out, Index in) {
  BlockOperator made;
  made.form_ = Form::kSpecular;
  made.diagonal_ = diagonal;
  made.out_ = out;
  made.in_ = in;
  return made;
}

BlockOperator BlockOperator::isotropic(std::shared_ptr<const OrderMatrices> orders, std::vector<std::size_t> order_of) {
  BlockOperator made;
  made.form_ = Form::kIsotropic;
  made.orders_ = std::move(orders);
  made.order_of_ = std::move(order_of);
  return made;
}

BlockOperator BlockOperator::coupled(const MatrixXd& matrix) {
  BlockOperator made;
  made.form_ = Form::kCoupled;
  made.matrix_ = &matrix;
  return made;
}

MatrixXd BlockOperator::apply(const MatrixXd& columns, Index rows, bool transposed) const {
  if (form_ == Form::kCoupled) {
    return transposed ? MatrixXd(matrix_->transpose() * columns) : MatrixXd(*matrix_ * columns);
  }
  MatrixXd result = MatrixXd::Zero(rows, columns.cols());
  if (form_ == Form::kSpecular) {
    const Index out = transposed ? in_ : out_;
    const Index in = transposed ? out_ : in_;
    const Index common = std::min({out, in, diagonal_.size()});
    for (Index f = 0; f < rows / out; ++f) {
      result.middleRows(f * out, common) = diagonal_.head(common).asDiagonal() * columns.middleRows(f * in, common);
    }
  } else if (form_ == Form::kIsotropic) {
    for (std::size_t f = 0; f < order_of_.size(); ++f) {
      const MatrixXd& matrix = (*orders_)[order_of_[f]];  // symmetric, as layers are the same from both sides
      const Index at = static_cast<Index>(f) * matrix.rows();
      result.middleRows(at, matrix.rows()).noalias() = matrix * columns.middleRows(at, matrix.rows());
    }
  }
  return result;
}

void BlockOperator::add_to(MatrixXd& matrix) const {
  if (form_ == Form::kCoupled) {
    matrix += *matrix_;
  } else if (form_ == Form::kSpecular) {
    for (Index f = 0; f < matrix.rows() / out_; ++f) {
      matrix.diagonal().segment(f * out_, diagonal_.size()) += diagonal_;
    }
  } else if (form_ == Form::kIsotropic) {
    for (std::size_t f = 0; f < order_of_.size(); ++f) {
      const MatrixXd& own = (*orders_)[order_of_[f]];
      matrix.block(static_cast<Index>(f) * own.rows(), static_cast<Index>(f) * own.rows(), own.rows(), own.rows()) +=
          own;
    }
  }
}

}  // namespace lamina
