// SPDX-License-Identifier: GPL-3.0-or-later
#include "numeric/legendre.hpp"

#include <cmath>

namespace lamina {

Eigen::MatrixXd associated_legendre(int order, int count, const Eigen::VectorXd& mu) {
  if (count <= order) {
    return Eigen::MatrixXd(0, mu.size());
  }
  Eigen::MatrixXd values(count - order, mu.size());
  const double m = order;
  // Three-term recurrence in the degree, stable upwards; its square roots do not depend on the cosine.
  double sectoral_factor = 1.0;
  for (int k = 1; k <= order; ++k) {
    sectoral_factor *= std::sqrt((2.0 * k - 1.0) / (2.0 * k));
  }
  Eigen::VectorXd ascending(count - order);
  Eigen::VectorXd scale(count - order);
  for (int l = order + 1; l < count; ++l) {
    ascending[l - order] = std::sqrt((l - 1.0) * (l - 1.0) - m * m);
    scale[l - order] = 1.0 / std::sqrt(double(l) * l - m * m);
  }
  for (Eigen::Index column = 0; column < mu.size(); ++column) {
    const double x = mu[column];
    const double sine = std::sqrt(std::max(0.0, 1.0 - x * x));
    double before = 0.0;
    double last = sectoral_factor * std::pow(sine, order);
    values(0, column) = last;
    for (int l = order + 1; l < count; ++l) {
      const double next = ((2.0 * l - 1.0) * x * last - ascending[l - order] * before) * scale[l - order];
      before = last;
      last = next;
      values(l - order, column) = next;
    }
  }
  return values;
}

}  // namespace lamina
