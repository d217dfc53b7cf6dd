// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/normalising_share.hpp"

namespace lamina {

Eigen::MatrixXd normalising_share(const Eigen::MatrixXd& scattered, const Eigen::VectorXd& root) {
  const double whole = root.squaredNorm();
  const Eigen::VectorXd missing = (root - scattered * root).cwiseQuotient(root) / whole;
  const double mean = missing.dot(root.cwiseAbs2()) / whole;
  const Eigen::Index n = root.size();
  return root.asDiagonal() *
         (missing.replicate(1, n) + missing.transpose().replicate(n, 1) - Eigen::MatrixXd::Constant(n, n, mean)) *
         root.asDiagonal();
}

}  // namespace lamina
