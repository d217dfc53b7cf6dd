// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Legendre quadrature.
#pragma once
#include <Eigen/Core>

namespace lamina {

/// Gauss-Legendre nodes and weights on (low, high), nodes ascending.
struct Quadrature {
  Eigen::VectorXd mu;
  Eigen::VectorXd weight;

  explicit Quadrature(int count, double low = 0.0, double high = 1.0);

  double low() const { return low_; }
  double high() const { return high_; }

  /// The largest error of the moments int x^k dx, k < 2 count, x in (0, 1) across the range.
  double moment_error() const;

  /// Row of polynomial interpolation from the nodes to any point.
  Eigen::RowVectorXd interpolate(double point) const;
  /// Writes the row to given memory.
  void interpolate(double point, Eigen::Ref<Eigen::VectorXd> values) const;

 private:
  double low_;
  double high_;
  Eigen::VectorXd barycentric_;
};

}  // namespace lamina
