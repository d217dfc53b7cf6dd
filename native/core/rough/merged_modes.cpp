// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/merged_modes.hpp"

#include <Eigen/QR>

#include "numeric/legendre.hpp"

namespace lamina {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Modes::Modes(const DirectionSet& set, const Directions& nodes, const VectorXd& factor)
    : basis(MatrixXd::Zero(nodes.live, nodes.live)), degree(nodes.live) {
  Eigen::Index first = 0;
  for (const DirectionSet::Range& range : set.ranges()) {
    const Eigen::Index n = range.nodes.mu.size();
    if (range.ior > nodes.ior) {
      break;
    }
    const VectorXd x =
        2.0 * (range.nodes.mu.array() - range.nodes.low()) / (range.nodes.high() - range.nodes.low()) - 1.0;
    const VectorXd common = nodes.scale.segment(first, n).cwiseProduct(factor.segment(first, n));
    const MatrixXd powers = common.asDiagonal() * associated_legendre(0, static_cast<int>(n), x).transpose().eval();
    basis.block(first, first, n, n) = powers.householderQr().householderQ();
    degree.segment(first, n) = Eigen::VectorXi::LinSpaced(static_cast<int>(n), 0, static_cast<int>(n) - 1);
    first += n;
  }
}

MatrixXd merged(const MatrixXd& one, const MatrixXd& other, const Modes& out, const Modes& in) {
  MatrixXd modes = out.basis.transpose() * one * in.basis;
  const MatrixXd back = in.basis.transpose() * other * out.basis;
  for (Eigen::Index k = 0; k < modes.cols(); ++k) {
    for (Eigen::Index l = 0; l < modes.rows(); ++l) {
      if (out.degree[l] > in.degree[k]) {
        modes(l, k) = back(k, l);
      } else if (out.degree[l] == in.degree[k]) {
        modes(l, k) = 0.5 * (modes(l, k) + back(k, l));
      }
    }
  }
  return out.basis * modes * in.basis.transpose();
}

}  // namespace lamina
