// SPDX-License-Identifier: GPL-3.0-or-later
#include "lobe_operator.hpp"

namespace lamina {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

LobeOperator::LobeOperator(Lobe lobe, const AzimuthTransform& azimuth, const DirectionSet& set,
                           const DirectionSet& fine, double ior_out, double ior_in, ThreadPool& pool)
    : lobe_(std::move(lobe)),
      azimuth_(azimuth),
      fine_out_(fine.in_medium(ior_out, VectorXd())),
      fine_in_(fine.in_medium(ior_in, VectorXd())) {
  const MatrixXd carry = set.carry_to(fine);
  carry_out_ = carry.topLeftCorner(fine_out_.live, set.in_medium(ior_out, VectorXd()).live);
  carry_in_ = carry.topLeftCorner(fine_in_.live, set.in_medium(ior_in, VectorXd()).live);
  nodes_ = between(fine_out_.mu, fine_out_.scale, fine_in_.mu, fine_in_.scale, pool);
  for (MatrixXd& order : nodes_) {
    order = (carry_out_.transpose() * order * carry_in_).eval();
  }
}

std::vector<MatrixXd> LobeOperator::on(const Directions& out, const Directions& in, ThreadPool& pool) const {
  const VectorXd out_mu = out.mu.tail(out.targets);
  const VectorXd out_scale = out.scale.tail(out.targets);
  const VectorXd in_mu = in.mu.tail(in.targets);
  const VectorXd in_scale = in.scale.tail(in.targets);
  const std::vector<MatrixXd> leaving = between(out_mu, out_scale, fine_in_.mu, fine_in_.scale, pool);
  const std::vector<MatrixXd> arriving = between(fine_out_.mu, fine_out_.scale, in_mu, in_scale, pool);
  std::vector<MatrixXd> orders(nodes_.size());
  pool.run(orders.size(), [&](std::size_t m) {
    MatrixXd all = MatrixXd::Zero(out.size(), in.size());
    all.topLeftCorner(out.live, in.live) = nodes_[m];
    all.bottomLeftCorner(out.targets, in.live) = leaving[m] * carry_in_;
    all.topRightCorner(out.live, in.targets) = carry_out_.transpose() * arriving[m];
    orders[m] = std::move(all);
  });
  return orders;
}

/// Scaled Fourier coefficients of the lobe between two lists of directions, by order.
std::vector<MatrixXd> LobeOperator::between(const VectorXd& mu_out, const VectorXd& scale_out, const VectorXd& mu_in,
                                            const VectorXd& scale_in, ThreadPool& pool) const {
  const Index count = azimuth_.to_orders.rows();
  std::vector<MatrixXd> orders(static_cast<std::size_t>(count), MatrixXd(mu_out.size(), mu_in.size()));
  pool.run(static_cast<std::size_t>(mu_out.size()), [&](std::size_t k) {
    const auto row = static_cast<Index>(k);
    MatrixXd samples(azimuth_.cosines.size(), mu_in.size());
    for (Index column = 0; column < mu_in.size(); ++column) {
      samples.col(column) = lobe_(mu_out[row], mu_in[column], azimuth_.cosines).matrix();
    }
    const MatrixXd coefficients = scale_out[row] * (azimuth_.to_orders * samples) * scale_in.asDiagonal();
    for (Index m = 0; m < count; ++m) {
      orders[static_cast<std::size_t>(m)].row(row) = coefficients.row(m);
    }
  });
  return orders;
}

}  // namespace lamina
