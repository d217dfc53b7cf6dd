// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/phase_kernel.hpp"

#include <algorithm>

#include "numeric/legendre.hpp"

namespace lamina {

Eigen::VectorXd phase_weights(const TruncatedMedium& medium, int order) {
  const int count = static_cast<int>(medium.moments.size());
  Eigen::VectorXd weights(std::max(0, count - order));
  for (int l = order; l < count; ++l) {
    weights[l - order] = (2.0 * l + 1.0) * medium.moments[static_cast<std::size_t>(l)];
  }
  return weights;
}

PhaseKernel::PhaseKernel(const TruncatedMedium& medium, int order, const Eigen::VectorXd& mu) {
  const int count = static_cast<int>(medium.moments.size());
  const Eigen::MatrixXd legendre = associated_legendre(order, count, mu);
  const Eigen::VectorXd weights = phase_weights(medium, order);
  const auto share = [&](Eigen::Index parity) {
    const Eigen::Index terms = (legendre.rows() - parity + 1) / 2;
    Eigen::MatrixXd rows(std::max<Eigen::Index>(terms, 0), mu.size());
    Eigen::VectorXd factors(rows.rows());
    for (Eigen::Index k = 0; k < terms; ++k) {
      rows.row(k) = legendre.row(2 * k + parity);
      factors[k] = weights[2 * k + parity];
    }
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(mu.size(), mu.size());
    if (terms <= 0) {
      return sum;
    }
    const Eigen::MatrixXd weighted = factors.asDiagonal() * rows;
    sum.triangularView<Eigen::Lower>() = rows.transpose() * weighted;
    sum.triangularView<Eigen::StrictlyUpper>() = sum.transpose();
    return sum;
  };
  const Eigen::MatrixXd even = share(0);
  const Eigen::MatrixXd odd = share(1);
  // P_l^m(-mu) = (-1)^(l-m) P_l^m(mu).
  reflect = even - odd;
  transmit = even + odd;
}

}  // namespace lamina
