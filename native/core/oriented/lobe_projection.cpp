// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/lobe_projection.hpp"

#include <cmath>
#include <numbers>

namespace lamina {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Eigen::ArrayXd PoleFactor::at(std::size_t kind, const Eigen::ArrayXd& common_sines) {
  constexpr double kWidth = 0.2;  // of the region about the normal, as n sin(theta)
  const Eigen::ArrayXd even = common_sines.square() / (common_sines.square() + kWidth * kWidth);
  switch (kind) {
    case 0:
      return Eigen::ArrayXd::Ones(common_sines.size());
    case 1:
      return common_sines;
    case 2:
      return even;
    default:
      return common_sines * even;
  }
}

VectorXd PoleFactor::on(std::size_t kind, const Directions& directions) {
  return at(kind, directions.ior * (1.0 - directions.mu.head(directions.live).array().square()).max(0.0).sqrt());
}

LobeProjection::LobeProjection(const DirectionSet& set, double ior, int orders) : ior_(ior), azimuths_(orders, true) {
  Index first = 0;
  for (const DirectionSet::Range& range : set.ranges()) {
    if (range.ior <= ior) {
      parts_.push_back({&range, first});
      first += range.nodes.mu.size();
    }
  }
  const Directions nodes = set.in_medium(ior, VectorXd());
  inverse_common_ = (ior * nodes.scale).cwiseInverse();
  for (std::size_t kind = 0; kind < PoleFactor::kKinds; ++kind) {
    inverse_factors_[kind] = PoleFactor::on(kind, nodes).cwiseInverse();
  }
}

/// The range of nodes for a ray, and its cosine in the medium of that range.
std::size_t LobeProjection::part_of(double mu, double& own) const {
  std::size_t chosen = 0;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const double ratio = ior_ / parts_[k].range->ior;
    const double square = 1.0 - ratio * ratio * (1.0 - mu * mu);
    if (square >= 0.0) {
      own = std::sqrt(square);
      chosen = k;
      if (own <= parts_[k].range->nodes.high()) {
        break;
      }
    }
  }
  return chosen;
}

MatrixXd LobeProjection::sum(const RayList& rays) const {
  MatrixXd result = MatrixXd::Zero(inverse_common_.size(), azimuths_.count());
  std::vector<std::vector<std::size_t>> chosen(parts_.size());
  std::vector<double> cosines(rays.ray.size());
  for (std::size_t r = 0; r < rays.ray.size(); ++r) {
    chosen[part_of(rays.ray[r].mu, cosines[r])].push_back(r);
  }
  const int orders = azimuths_.orders;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Quadrature& nodes = parts_[p].range->nodes;
    const Index count = static_cast<Index>(chosen[p].size());
    MatrixXd cardinals(nodes.mu.size(), count);
    MatrixXd waves(count, azimuths_.count());
    Eigen::ArrayXd cosine(count);
    Eigen::ArrayXd sine(count);
    Eigen::ArrayXd across(count);
    Eigen::ArrayXd share(count);
    for (Index k = 0; k < count; ++k) {
      const std::size_t r = chosen[p][static_cast<std::size_t>(k)];
      const Heading& ray = rays.ray[r];
      nodes.interpolate(cosines[r], cardinals.col(k));
      const double flat = std::hypot(ray.x, ray.y);
      cosine[k] = flat > 0.0 ? ray.x / flat : 1.0;
      sine[k] = flat > 0.0 ? ray.y / flat : 0.0;
      across[k] = ior_ * flat;
      share[k] = rays.share[r];
    }
    waves.col(0) = share;
    if (orders > 1) {
      waves.col(1) = std::numbers::sqrt2 * share * cosine;
      waves.col(orders) = std::numbers::sqrt2 * share * sine;
      for (int m = 2; m < orders; ++m) {
        const auto before = [&](int function, double start) -> Eigen::ArrayXd {
          return m == 2 ? Eigen::ArrayXd(start * share) : Eigen::ArrayXd(waves.col(function - 2).array());
        };
        waves.col(m) = 2.0 * cosine * waves.col(m - 1).array() - before(m, std::numbers::sqrt2);
        waves.col(orders - 1 + m) = 2.0 * cosine * waves.col(orders - 2 + m).array() - before(orders - 1 + m, 0.0);
      }
      std::array<Eigen::ArrayXd, PoleFactor::kKinds> factors;
      for (std::size_t kind = 1; kind < factors.size(); ++kind) {
        factors[kind] = PoleFactor::at(kind, across);
      }
      for (int m = 1; m < orders; ++m) {
        waves.col(m).array() *= factors[PoleFactor::kind_of(m)];
        waves.col(orders - 1 + m).array() *= factors[PoleFactor::kind_of(m)];
      }
    }
    result.middleRows(parts_[p].first, nodes.mu.size()).noalias() = cardinals * waves;
  }
  for (int m = 1; m < orders; ++m) {
    result.col(m).array() *= inverse_factors_[PoleFactor::kind_of(m)].array();
    result.col(orders - 1 + m).array() *= inverse_factors_[PoleFactor::kind_of(m)].array();
  }
  return inverse_common_.asDiagonal() * result;
}

}  // namespace lamina
