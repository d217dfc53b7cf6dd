// SPDX-License-Identifier: GPL-3.0-or-later
#include "lobe_operator.hpp"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The ranges of nodes that exist in one medium, and sums over rays in it of share * polynomial * cos(m phi).
class Projection {
 public:
  Projection(const DirectionSet& set, double ior) : ior_(ior) {
    for (const DirectionSet::Range& range : set.ranges()) {
      if (range.ior <= ior) {
        parts_.push_back({&range, live_, {}, {}});
        live_ += range.nodes.mu.size();
      }
    }
    inverse_common_.resize(live_);
    for (const Part& part : parts_) {
      const Quadrature& nodes = part.range->nodes;
      inverse_common_.segment(part.first, nodes.mu.size()) =
          (2.0 * nodes.mu.array() * nodes.weight.array()).sqrt().inverse() / part.range->ior;
    }
  }

  Index live() const { return live_; }

  /// Live nodes by orders.
  MatrixXd sum(const Rays& rays, int orders) {
    for (Part& part : parts_) {
      part.own.clear();
      part.rays.clear();
    }
    for (std::size_t k = 0; k < rays.mu.size(); ++k) {
      sort_in(rays.mu[k], k);
    }
    MatrixXd result = MatrixXd::Zero(live_, orders);
    for (const Part& part : parts_) {
      const Quadrature& nodes = part.range->nodes;
      const auto count = static_cast<Index>(part.rays.size());
      polynomials_.resize(nodes.mu.size(), count);
      waves_.resize(count, orders);
      cosines_.resize(count);
      for (Index k = 0; k < count; ++k) {
        const std::size_t ray = part.rays[static_cast<std::size_t>(k)];
        nodes.interpolate(part.own[static_cast<std::size_t>(k)], polynomials_.col(k));
        waves_(k, 0) = rays.share[ray];
        cosines_[k] = rays.azimuth[ray];
      }
      // cos((m + 1) phi) = 2 cos(phi) cos(m phi) - cos((m - 1) phi).
      for (Index m = 1; m < orders; ++m) {
        waves_.col(m) = cosines_.cwiseProduct(waves_.col(m - 1));
        if (m > 1) {
          waves_.col(m) = 2.0 * waves_.col(m) - waves_.col(m - 2);
        }
      }
      result.middleRows(part.first, nodes.mu.size()).noalias() = polynomials_ * waves_;
    }
    return inverse_common_.asDiagonal() * result;
  }

 private:
  struct Part {
    const DirectionSet::Range* range;
    Index first;
    std::vector<double> own;  // of the rays in this range, in the medium that the range belongs to
    std::vector<std::size_t> rays;
  };

  void sort_in(double mu, std::size_t ray) {
    double own = mu;
    Part* chosen = nullptr;
    for (Part& part : parts_) {
      const double ratio = ior_ / part.range->ior;
      const double square = ratio == 1.0 ? mu * mu : 1.0 - ratio * ratio * (1.0 - mu * mu);
      if (square < 0.0) {
        continue;
      }
      own = std::sqrt(square);
      chosen = &part;
      if (own <= part.range->nodes.high()) {
        break;
      }
    }
    chosen->own.push_back(own);
    chosen->rays.push_back(ray);
  }

  double ior_;
  Index live_ = 0;
  std::vector<Part> parts_;
  VectorXd inverse_common_;
  MatrixXd polynomials_;
  MatrixXd waves_;
  VectorXd cosines_;
};

}  // namespace

LobeOperator::Columns LobeOperator::from(const VectorXd& mu, const VectorXd& common, ThreadPool& pool) const {
  Columns columns;
  const auto shape = [&](std::vector<MatrixXd>& matrices, double ior) {
    matrices.assign(static_cast<std::size_t>(orders_), MatrixXd(Projection(set_, ior).live(), mu.size()));
  };
  shape(columns.reflected, ior_);
  if (beyond_ > 0.0) {
    shape(columns.transmitted, beyond_);
  }
  constexpr Index kChunk = 4;
  pool.run(static_cast<std::size_t>((mu.size() + kChunk - 1) / kChunk), [&](std::size_t chunk) {
    Rays reflected;
    Rays transmitted;
    Projection own(set_, ior_);
    Projection other(set_, beyond_);
    const Index first = static_cast<Index>(chunk) * kChunk;
    for (Index i = first; i < std::min(first + kChunk, mu.size()); ++i) {
      rays_.scatter(mu[i], reflected, transmitted);
      const auto keep = [&](std::vector<MatrixXd>& matrices, const MatrixXd& sums) {
        for (std::size_t m = 0; m < matrices.size(); ++m) {
          matrices[m].col(i) = common[i] * sums.col(static_cast<Index>(m));
        }
      };
      keep(columns.reflected, own.sum(reflected, orders_));
      if (beyond_ > 0.0) {
        keep(columns.transmitted, other.sum(transmitted, orders_));
      }
    }
  });
  return columns;
}

LobeOperator::Columns LobeOperator::on_nodes(ThreadPool& pool) const {
  constexpr double kFiner = 1.5;
  const DirectionSet fine = set_.finer_by(kFiner);
  const Directions in = fine.in_medium(ior_, VectorXd());
  const Index live = set_.in_medium(ior_, VectorXd()).live;
  const MatrixXd carry = set_.carry_to(fine).topLeftCorner(in.live, live);
  Columns columns = from(in.mu, ior_ * in.scale, pool);
  for (std::vector<MatrixXd>* matrices : {&columns.reflected, &columns.transmitted}) {
    for (MatrixXd& matrix : *matrices) {
      matrix = (matrix * carry).eval();
    }
  }
  return columns;
}

}  // namespace lamina
