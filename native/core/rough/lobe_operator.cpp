// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/lobe_operator.hpp"

#include <algorithm>
#include <cmath>

#include "rough/wave_grid.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The ranges of nodes that exist in one medium.
struct Part {
  const DirectionSet::Range* range;
  Index first;
  WaveTables tables;
};

std::vector<Part> parts_of(const DirectionSet& set, double ior, int orders) {
  std::vector<Part> parts;
  Index first = 0;
  for (const DirectionSet::Range& range : set.ranges()) {
    if (range.ior <= ior) {
      parts.push_back({&range, first, WaveTables(range.nodes, orders)});
      first += range.nodes.mu.size();
    }
  }
  return parts;
}

Index live_nodes(const std::vector<Part>& parts) {
  return parts.empty() ? 0 : parts.back().first + parts.back().range->nodes.mu.size();
}

/// Sums share * polynomial * cos(m phi) over the rays in a medium.
class Projection {
 public:
  Projection(const std::vector<Part>& parts, double ior)
      : parts_(parts), ior_(ior), inverse_common_(live_nodes(parts)) {
    for (const Part& part : parts_) {
      const Quadrature& nodes = part.range->nodes;
      inverse_common_.segment(part.first, nodes.mu.size()) =
          (2.0 * nodes.mu.array() * nodes.weight.array()).sqrt().inverse() / part.range->ior;
      grids_.emplace_back(part.tables);
    }
  }

  /// The sums, [live node, order].
  MatrixXd sum(const Rays& rays, int orders) {
    for (WaveGrid& grid : grids_) {
      grid.clear();
    }
    for (std::size_t k = 0; k < rays.mu.size(); ++k) {
      add(rays.share[k], rays.mu[k], rays.azimuth[k]);
    }
    MatrixXd result(inverse_common_.size(), orders);
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      result.middleRows(parts_[k].first, parts_[k].range->nodes.mu.size()) = grids_[k].sums();
    }
    return inverse_common_.asDiagonal() * result;
  }

 private:
  /// Adds a ray to the grid of its range, with its cosine in the medium of the range.
  void add(double share, double mu, double azimuth) {
    double own = mu;
    std::size_t chosen = 0;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const double ratio = ior_ / parts_[k].range->ior;
      const double square = ratio == 1.0 ? mu * mu : 1.0 - ratio * ratio * (1.0 - mu * mu);
      if (square < 0.0) {
        continue;
      }
      own = std::sqrt(square);
      chosen = k;
      if (own <= parts_[k].range->nodes.high()) {
        break;
      }
    }
    grids_[chosen].add(share, own, azimuth);
  }

  const std::vector<Part>& parts_;
  double ior_;
  VectorXd inverse_common_;
  std::vector<WaveGrid> grids_;
};

}  // namespace

std::shared_ptr<const LobeColumns> LobeOperator::from_targets(const Directions& directions, ThreadPool& pool) const {
  return last_->known_or_made(
      directions, [&](const VectorXd& mu, const VectorXd& common) { return columns_from(mu, common, pool); });
}

LobeColumns LobeOperator::columns_from(const VectorXd& mu, const VectorXd& common, ThreadPool& pool) const {
  LobeColumns columns;
  const std::vector<Part> here = parts_of(set_, ior_, orders_);
  const std::vector<Part> there = parts_of(set_, beyond_, orders_);
  const auto shape = [&](std::vector<MatrixXd>& matrices, const std::vector<Part>& parts) {
    matrices.assign(static_cast<std::size_t>(orders_), MatrixXd(live_nodes(parts), mu.size()));
  };
  shape(columns.reflected, here);
  if (beyond_ > 0.0) {
    shape(columns.transmitted, there);
  }
  constexpr Index kChunk = 4;  // directions per task
  pool.run(static_cast<std::size_t>((mu.size() + kChunk - 1) / kChunk), [&](std::size_t chunk) {
    Rays reflected;
    Rays transmitted;
    Projection own(here, ior_);
    Projection other(there, beyond_);
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

LobeColumns LobeOperator::on_nodes(ThreadPool& pool) const {
  constexpr double kFiner = 1.5;  // density of the quadrature on the incoming side, see LobeOperator
  const DirectionSet fine = set_.finer_by(kFiner);
  const Directions in = fine.in_medium(ior_, VectorXd());
  const Index live = set_.in_medium(ior_, VectorXd()).live;
  const MatrixXd carry = set_.carry_to(fine).topLeftCorner(in.live, live);
  LobeColumns sums;
  constexpr Index kBlock = 64;  // the columns of all finer nodes at once would take 1.5 times the memory of the result
  for (Index first = 0; first < in.live; first += kBlock) {
    const Index count = std::min(kBlock, in.live - first);
    const LobeColumns block = columns_from(in.mu.segment(first, count), ior_ * in.scale.segment(first, count), pool);
    const auto add = [&](std::vector<MatrixXd>& all, const std::vector<MatrixXd>& some) {
      all.resize(some.size());
      pool.run(some.size(), [&](std::size_t m) {
        if (first == 0) {
          all[m].setZero(some[m].rows(), live);
        }
        all[m].noalias() += some[m] * carry.middleRows(first, count);
      });
    };
    add(sums.reflected, block.reflected);
    add(sums.transmitted, block.transmitted);
  }
  return sums;
}

}  // namespace lamina
