// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/azimuth_rule.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace lamina {

AzimuthRule::AzimuthRule(Eigen::Index azimuths, double bend, Eigen::Index orders)
    : count(azimuths),
      wave(Eigen::MatrixXd::Zero(azimuths, azimuths)),
      to_orders(Eigen::MatrixXd::Zero(orders, azimuths)),
      from_orders(Eigen::MatrixXd::Zero(azimuths, orders)) {
  if (count == 1) {
    to_orders.row(0).setOnes();
    from_orders.col(0).setOnes();
    return;
  }
  using Complex = std::complex<double>;
  const Eigen::Index pairs = count / 2;
  cosines.resize(pairs);
  weights.resize(pairs);
  for (Eigen::Index j = 0; j < pairs; ++j) {
    const double x = (static_cast<double>(j) + 0.5) * std::numbers::pi / static_cast<double>(count);
    const Complex phi(x, bend * std::sin(x));
    const Complex weight = Complex(1.0, bend * std::cos(x)) / static_cast<double>(count);
    const Complex rate = Complex(0.0, 1.0) * std::cos(phi);
    cosines[j] = std::cos(phi);
    weights[j] = 2.0 * weight;
    wave(j, j) = wave(pairs + j, pairs + j) = rate.real();
    wave(pairs + j, j) = rate.imag();
    wave(j, pairs + j) = -rate.imag();
    for (Eigen::Index m = 0; m < orders; ++m) {
      const Complex wave_of_order = (m == 0 ? 1.0 : std::numbers::sqrt2) * std::cos(static_cast<double>(m) * phi);
      const Complex sum = 2.0 * weight * wave_of_order;
      if (m % 2 == 0) {
        to_orders(m, j) = sum.real();
        to_orders(m, pairs + j) = -sum.imag();
        from_orders(j, m) = wave_of_order.real();
        from_orders(pairs + j, m) = wave_of_order.imag();
      } else {
        to_orders(m, j) = sum.imag();
        to_orders(m, pairs + j) = sum.real();
        from_orders(j, m) = -wave_of_order.imag();
        from_orders(pairs + j, m) = wave_of_order.real();
      }
    }
  }
  constexpr double kApart = 1e-2;
  constexpr double kApartFromMean = 1e-6;
  const Eigen::MatrixXd products = to_orders * from_orders - Eigen::MatrixXd::Identity(orders, orders);
  while (orders_apart < orders && std::abs(products(0, orders_apart)) < kApartFromMean &&
         products.col(orders_apart).head(orders_apart + 1).cwiseAbs().maxCoeff() < kApart) {
    ++orders_apart;
  }
}

}  // namespace lamina
