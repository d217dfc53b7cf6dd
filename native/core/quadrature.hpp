// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

namespace lamina {

/// Gauss-Legendre nodes and weights on (0, 1), nodes ascending: a hemisphere's cosines ("double Gauss").
struct Quadrature {
  Eigen::VectorXd mu;
  Eigen::VectorXd weight;

  explicit Quadrature(int count);

  /// The largest error of the moments int mu^k dmu = 1/(k+1), k < 2 count.
  double moment_error() const;
};

/// The directions of one solve or one look-up: the quadrature's nodes, over which integrals run, then
/// extra *targets*, where functions are wanted but which no integral sees (Nystrom's interpolation).
/// `scale` is sqrt(2 mu w) at nodes and 1 at targets: with it, the kernels pi * BRDF of reciprocal layers
/// become symmetric matrices whose products are the integrals.
struct Directions {
  Eigen::VectorXd mu;
  Eigen::VectorXd scale;
  Eigen::Index nodes = 0;
  Eigen::MatrixXd interpolation;  ///< polynomial interpolation from the nodes to all directions

  Directions(const Quadrature& quadrature, const Eigen::VectorXd& targets);
  Eigen::Index size() const { return mu.size(); }
};

}  // namespace lamina
