// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/lobe_values.hpp"

#include <cmath>
#include <numbers>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// A quadrature over azimuths 0 to pi for cos(m phi) times lobes. Between grazing directions, lobes are as narrow as
/// their cosines: Gauss rules on intervals that are halved towards azimuth 0.
struct Azimuths {
  ArrayXd cosines;
  MatrixXd waves;  ///< weight * cos(m phi), [azimuth, order]

  Azimuths(double narrowest, int orders) {
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
    const VectorXd azimuth = Eigen::Map<const VectorXd>(at.data(), count);
    cosines = azimuth.array().cos();
    waves.resize(count, orders);
    for (Index m = 0; m < orders; ++m) {
      waves.col(m) = Eigen::Map<const ArrayXd>(weight.data(), count) * (static_cast<double>(m) * azimuth.array()).cos();
    }
  }
};

/// The orders of the lobe between one direction and many: [direction, order].
MatrixXd orders_between(const LobeValues& lobe, double mu, const VectorXd& towards, const Azimuths& azimuths) {
  return lobe(mu, {towards, azimuths.cosines.transpose().replicate(towards.size(), 1)}).matrix() * azimuths.waves;
}

/// The error of the interpolation from the nodes at every fourth of finer nodes, relative to the mean over azimuths.
/// Pairs with a grazing direction do not count: the mean over azimuths has a logarithm there.
double interpolation_error(const std::vector<MatrixXd>& matrices, const LobeValues& lobe, const DirectionSet& set,
                           double ior, const Azimuths& azimuths, ThreadPool& pool) {
  constexpr double kFiner = 1.5;
  constexpr Index kStep = 4;
  constexpr double kGrazing = 0.04;
  const DirectionSet fine = set.finer_by(kFiner);
  const Directions nodes = set.in_medium(ior, VectorXd());
  const Directions finer = fine.in_medium(ior, VectorXd());
  const MatrixXd carry = set.carry_to(fine).topLeftCorner(finer.live, nodes.live);
  std::vector<Index> rows;
  for (Index k = 0; k < finer.live; k += kStep) {
    if (finer.mu[k] > kGrazing) {
      rows.push_back(k);
    }
  }
  MatrixXd squares(azimuths.waves.cols(), static_cast<Index>(rows.size()));
  VectorXd means(static_cast<Index>(rows.size()));
  pool.run(rows.size(), [&](std::size_t k) {
    const auto column = static_cast<Index>(k);
    const Index row = rows[k];
    const double own = ior * finer.scale[row];
    const MatrixXd exact =
        own * (ior * nodes.scale).asDiagonal() * orders_between(lobe, finer.mu[row], nodes.mu, azimuths);
    for (Index m = 0; m < exact.cols(); ++m) {
      const MatrixXd& matrix = matrices[static_cast<std::size_t>(m)];
      const VectorXd error = exact.col(m) - matrix * carry.row(row).transpose();
      squares(m, column) = (nodes.mu.array() > kGrazing).select(error, 0.0).squaredNorm();
    }
    means[column] = exact.col(0).squaredNorm();
  });
  return std::sqrt(squares.rowwise().sum().maxCoeff() / means.sum());
}

}  // namespace

std::vector<MatrixXd> resolved_lobe(const LobeValues& lobe, const DirectionSet& set, double ior, int orders,
                                    double alpha, double tolerance, ThreadPool& pool) {
  const Directions nodes = set.in_medium(ior, VectorXd());
  const Azimuths azimuths(alpha * nodes.mu.minCoeff(), orders);
  std::vector<MatrixXd> matrices(static_cast<std::size_t>(orders), MatrixXd(nodes.live, nodes.live));
  const VectorXd common = ior * nodes.scale;
  pool.run(static_cast<std::size_t>(nodes.live), [&](std::size_t column) {
    const auto i = static_cast<Index>(column);
    const MatrixXd values =
        common[i] * common.head(i + 1).asDiagonal() * orders_between(lobe, nodes.mu[i], nodes.mu.head(i + 1), azimuths);
    for (Index m = 0; m < values.cols(); ++m) {
      MatrixXd& matrix = matrices[static_cast<std::size_t>(m)];
      matrix.col(i).head(i + 1) = values.col(m);
      matrix.row(i).head(i + 1) = values.col(m).transpose();
    }
  });
  if (!(interpolation_error(matrices, lobe, set, ior, azimuths, pool) < tolerance)) {
    matrices.clear();
  }
  return matrices;
}

}  // namespace lamina
