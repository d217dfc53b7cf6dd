// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/resolved_lobe.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "numeric/quadrature.hpp"

namespace lamina {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// Between grazing directions, lobes are as narrow as their cosines: Gauss rules on intervals that are halved towards
/// azimuth 0.
ResolvedLobe::Azimuths::Azimuths(double narrowest, int orders) {
  constexpr double kPerInterval = 8.0;
  constexpr double kPerRadian = 0.8;  // of a wave
  std::vector<double> at;
  std::vector<double> weight;
  double high = pi;
  while (high > 0.0) {
    const double low = high > narrowest ? 0.5 * high : 0.0;
    const Quadrature rule(static_cast<int>(std::ceil(kPerInterval + kPerRadian * orders * (high - low))));
    for (Index k = 0; k < rule.mu.size(); ++k) {
      at.push_back(low + (high - low) * rule.mu[k]);
      weight.push_back((high - low) * rule.weight[k]);
    }
    high = low;
  }
  const auto count = static_cast<Index>(at.size());
  const Eigen::Map<const ArrayXd> azimuth(at.data(), count);
  cosines = azimuth.cos();
  waves.resize(count, orders);
  for (Index m = 0; m < orders; ++m) {
    waves.col(m) = Eigen::Map<const ArrayXd>(weight.data(), count) * (static_cast<double>(m) * azimuth).cos();
  }
}

ResolvedLobe::ResolvedLobe(LobeValues lobe, DirectionSet set, double ior, double alpha, int orders)
    : lobe_(std::move(lobe)),
      set_(std::move(set)),
      nodes_(set_.in_medium(ior, VectorXd())),
      common_(ior * nodes_.scale),
      azimuths_(alpha * nodes_.mu.minCoeff(), orders) {}

/// The orders of the lobe between a direction, with C = `common` there, and the first nodes: [node, order].
MatrixXd ResolvedLobe::between(double mu, double common, Index nodes) const {
  const FacetPairs pairs{nodes_.mu.head(nodes), azimuths_.cosines.transpose().replicate(nodes, 1)};
  return common * common_.head(nodes).asDiagonal() * (lobe_(mu, pairs).matrix() * azimuths_.waves);
}

std::vector<MatrixXd> ResolvedLobe::on_nodes(ThreadPool& pool) const {
  std::vector<MatrixXd> matrices(static_cast<std::size_t>(azimuths_.waves.cols()), MatrixXd(nodes_.live, nodes_.live));
  pool.run(static_cast<std::size_t>(nodes_.live), [&](std::size_t column) {
    const auto i = static_cast<Index>(column);
    const MatrixXd values = between(nodes_.mu[i], common_[i], i + 1);
    for (Index m = 0; m < values.cols(); ++m) {
      MatrixXd& matrix = matrices[static_cast<std::size_t>(m)];
      matrix.col(i).head(i + 1) = values.col(m);
      matrix.row(i).head(i + 1) = values.col(m).transpose();
    }
  });
  return matrices;
}

double ResolvedLobe::interpolation_error(const std::vector<MatrixXd>& matrices, ThreadPool& pool) const {
  constexpr double kFiner = 1.5;
  constexpr Index kStep = 4;
  constexpr double kGrazing = 0.04;
  const DirectionSet fine = set_.finer_by(kFiner);
  const Directions finer = fine.in_medium(nodes_.ior, VectorXd());
  const MatrixXd carry = set_.carry_to(fine).topLeftCorner(finer.live, nodes_.live);
  std::vector<Index> rows;
  for (Index k = 0; k < finer.live; k += kStep) {
    if (finer.mu[k] > kGrazing) {
      rows.push_back(k);
    }
  }
  MatrixXd squares(azimuths_.waves.cols(), static_cast<Index>(rows.size()));
  VectorXd means(static_cast<Index>(rows.size()));
  pool.run(rows.size(), [&](std::size_t k) {
    const auto column = static_cast<Index>(k);
    const Index row = rows[k];
    const MatrixXd exact = between(finer.mu[row], finer.ior * finer.scale[row], nodes_.live);
    for (Index m = 0; m < exact.cols(); ++m) {
      const MatrixXd& matrix = matrices[static_cast<std::size_t>(m)];
      const VectorXd error = exact.col(m) - matrix * carry.row(row).transpose();
      squares(m, column) = (nodes_.mu.array() > kGrazing).select(error, 0.0).squaredNorm();
    }
    means[column] = exact.col(0).squaredNorm();
  });
  return std::sqrt(squares.rowwise().sum().maxCoeff() / means.sum());
}

std::shared_ptr<const LobeColumns> ResolvedLobe::from_targets(const Directions& directions, ThreadPool& pool) const {
  return last_->known_or_made(directions, [&](const VectorXd& mu, const VectorXd& common) {
    LobeColumns columns;
    columns.reflected.assign(static_cast<std::size_t>(azimuths_.waves.cols()), MatrixXd(nodes_.live, mu.size()));
    pool.run(static_cast<std::size_t>(mu.size()), [&](std::size_t column) {
      const auto i = static_cast<Index>(column);
      const MatrixXd values = between(mu[i], common[i], nodes_.live);
      for (Index m = 0; m < values.cols(); ++m) {
        columns.reflected[static_cast<std::size_t>(m)].col(i) = values.col(m);
      }
    });
    return columns;
  });
}

}  // namespace lamina
