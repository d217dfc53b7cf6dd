// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/slice_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace lamina {

using Eigen::Index;

double fit_unit_norm(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                     const FitOptions& options, SmallVector& x) {
  const auto size = static_cast<Index>(chosen.size());
  if (!(target.norm2 > 0.0)) {
    x.setZero(size);
    return 0.0;
  }
  SmallMatrix matrix(size, size);
  SmallVector rhs(size);
  SmallVector albedo(size);
  for (Index j = 0; j < size; ++j) {
    const Index column = chosen[static_cast<std::size_t>(j)];
    for (Index i = 0; i < size; ++i) matrix(i, j) = gram.gram(chosen[static_cast<std::size_t>(i)], column);
    rhs[j] = target.rhs[column];
    albedo[j] = gram.albedo[column];
  }
  SmallMatrix plain = matrix;
  const SmallVector plain_rhs = rhs;
  // The albedo row, weighted relative to the slice: lambda (a.x - A)^2 with lambda = W norm2 / A^2.
  const bool has_albedo = target.albedo > 0.0;
  if (has_albedo) {
    const double lambda = options.albedo_weight * target.norm2 / (target.albedo * target.albedo);
    matrix.noalias() += lambda * albedo * albedo.transpose();
    rhs += lambda * target.albedo * albedo;
  }
  ActiveSet(matrix, rhs).solve(x);
  if (has_albedo) {
    const double reached = albedo.dot(x);
    if (reached > 0.0) x *= target.albedo / reached;
  }
  const double squared = target.norm2 - 2.0 * plain_rhs.dot(x) + x.dot(plain * x);
  return std::max(0.0, squared / target.norm2);
}

ColumnGram column_gram(const Eigen::Ref<const Eigen::MatrixXd>& values,
                       const Eigen::Ref<const Eigen::VectorXd>& solid_angle) {
  ColumnGram result;
  const Eigen::MatrixXd weighted = values * solid_angle.asDiagonal();
  result.gram.noalias() = weighted * values.transpose();
  result.scale = result.gram.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (result.scale.array() > 0.0).select(result.scale.cwiseInverse(), 0.0);
  result.gram = inverse.asDiagonal() * result.gram * inverse.asDiagonal();
  result.albedo = (values * solid_angle).cwiseProduct(inverse);
  return result;
}

SliceTarget slice_target(int column, const ColumnGram& gram, const Eigen::Ref<const Eigen::MatrixXd>& values,
                         const Eigen::Ref<const Eigen::VectorXd>& solid_angle,
                         const Eigen::Ref<const Eigen::VectorXd>& slice, double albedo) {
  SliceTarget target;
  target.column = column;
  const Eigen::VectorXd weighted = slice.cwiseProduct(solid_angle);
  target.norm2 = weighted.dot(slice);
  target.albedo = albedo;
  target.rhs = values * weighted;
  for (Index k = 0; k < target.rhs.size(); ++k)
    target.rhs[k] = gram.scale[k] > 0.0 ? target.rhs[k] / gram.scale[k] : 0.0;
  return target;
}

double fit_slice(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                 Eigen::Ref<Eigen::VectorXd> weights, const FitOptions& options) {
  if (chosen.size() > static_cast<std::size_t>(kMaxClosures))
    throw std::invalid_argument("fit_slice: more closures than kMaxClosures");
  SmallVector x = SmallVector::Zero(static_cast<Index>(chosen.size()));
  const double squared = fit_unit_norm(gram, target, chosen, options, x);
  for (Index k = 0; k < x.size(); ++k) {
    const double scale = gram.scale[chosen[static_cast<std::size_t>(k)]];
    weights[k] = scale > 0.0 ? x[k] / scale : 0.0;
  }
  return std::sqrt(squared);
}

}  // namespace lamina
