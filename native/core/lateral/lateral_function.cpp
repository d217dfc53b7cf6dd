// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/lateral_function.hpp"

#include <algorithm>

namespace lamina {

Eigen::MatrixXd from_orders(const std::vector<Eigen::MatrixXd>& orders, const LateralRows& rows) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows.size(), rows.size());
  const Eigen::Index n = rows.nodes;
  const AzimuthRule& out = rows.azimuths;
  const AzimuthRule& beam = rows.beam_azimuths;
  const Eigen::Index count = std::min<Eigen::Index>(out.orders_apart, static_cast<Eigen::Index>(orders.size()));
  for (Eigen::Index m = 0; m < count; ++m) {
    const Eigen::MatrixXd& order = orders[static_cast<std::size_t>(m)];
    for (Eigen::Index to = 0; to < out.count; ++to) {
      for (Eigen::Index from = 0; from < out.count; ++from) {
        all.block(to * n, from * n, n, n) +=
            out.from_orders(to, m) * out.to_orders(m, from) * order.topLeftCorner(n, n);
      }
      for (Eigen::Index from = 0; m < beam.orders_apart && from < beam.count; ++from) {
        all.block(to * n, rows.beam() + from, n, 1) +=
            out.from_orders(to, m) * beam.to_orders(m, from) * order.block(0, n, n, 1);
      }
    }
  }
  return all;
}

Eigen::MatrixXd from_delta(const Eigen::VectorXd& delta, const LateralRows& rows) {
  Eigen::VectorXd all(rows.size());
  all.head(rows.beam()) = delta.head(rows.nodes).replicate(rows.azimuths.count, 1);
  all.tail(rows.beam_azimuths.count).setConstant(delta[rows.nodes]);
  return all.asDiagonal();
}

}  // namespace lamina
