// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/azimuth_blocks.hpp"

#include <cmath>
#include <numbers>

namespace lamina {

AzimuthBlocks::AzimuthBlocks(int count_of_orders, bool mirror) : orders(count_of_orders), mirrored(mirror) {
  functions.resize(mirrored ? 4 : 2);
  for (const bool sine : {false, true}) {
    for (int m = sine ? 1 : 0; m < orders; ++m) {
      const std::size_t block = (mirrored && sine ? 2U : 0U) + static_cast<std::size_t>(m % 2);
      functions[block].push_back(sine ? orders - 1 + m : m);
    }
  }
}

Eigen::VectorXd AzimuthBlocks::at(double cosine, double sine) const {
  Eigen::VectorXd values(count());
  double c = 1.0;
  double s = 0.0;
  values[0] = 1.0;
  for (int m = 1; m < orders; ++m) {
    const double next = c * cosine - s * sine;
    s = s * cosine + c * sine;
    c = next;
    values[m] = std::numbers::sqrt2 * c;
    values[orders - 1 + m] = std::numbers::sqrt2 * s;
  }
  return values;
}

Eigen::VectorXd AzimuthBlocks::at(double phi) const { return at(std::cos(phi), std::sin(phi)); }

Eigen::MatrixXd AzimuthBlocks::turned(const Eigen::MatrixXd& coefficients, double angle) const {
  Eigen::MatrixXd result = coefficients;
  for (int m = 1; angle != 0.0 && m < orders; ++m) {
    const double c = std::cos(m * angle);
    const double s = std::sin(m * angle);
    const auto cosines = coefficients.col(m);
    const auto sines = coefficients.col(orders - 1 + m);
    result.col(m) = c * cosines - s * sines;
    result.col(orders - 1 + m) = s * cosines + c * sines;
  }
  return result;
}

}  // namespace lamina
