// SPDX-License-Identifier: GPL-3.0-or-later
#include "legendre.hpp"

#include <cmath>

namespace lamina {

Eigen::MatrixXd associated_legendre(int order, int count, const Eigen::VectorXd& mu) {
  if (count <= order) {
    return Eigen::MatrixXd(0, mu.size());
  }
  Eigen::MatrixXd values(count - order, mu.size());
  const double m = order;
  for (Eigen::Index column = 0; column < mu.size(); ++column) {
    const double x = mu[column];
    const double sine = std::sqrt(std::max(0.0, 1.0 - x * x));
    double sectoral = 1.0;
    for (int k = 1; k <= order; ++k) {
      sectoral *= sine * std::sqrt((2.0 * k - 1.0) / (2.0 * k));
    }
    double before = 0.0;
    double last = sectoral;
    values(0, column) = last;
    for (int l = order + 1; l < count; ++l) {
      // Three-term recurrence in the degree, stable upwards.
      const double ascending = std::sqrt((l - 1.0) * (l - 1.0) - m * m);
      const double next = ((2.0 * l - 1.0) * x * last - ascending * before) / std::sqrt(double(l) * l - m * m);
      before = last;
      last = next;
      values(l - order, column) = next;
    }
  }
  return values;
}

}  // namespace lamina
