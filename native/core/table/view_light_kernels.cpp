// SPDX-License-Identifier: GPL-3.0-or-later
#include "table/view_light_kernels.hpp"

#include <algorithm>
#include <cmath>

#include "matter/single_scattering_shape.hpp"
#include "numeric/legendre.hpp"
#include "operators/adding.hpp"

namespace lamina {
namespace {

using Eigen::Index;

/// The blocks of a symmetric function of two cosines and the thickness, scaled.
template <typename Shape>
KernelBlocks shape_blocks(const Directions& d, double tau, Shape shape) {
  const Index lights = d.targets - d.views;
  const auto value = [&](Index i, Index j) { return d.scale[i] * d.scale[j] * shape(d.mu[i], d.mu[j], tau); };
  KernelBlocks blocks{Eigen::MatrixXd(d.nodes, d.size()), Eigen::MatrixXd(d.views, lights)};
  for (Index j = 0; j < d.size(); ++j) {
    for (Index i = 0; i < std::min(j + 1, d.nodes); ++i) {
      blocks.nodes(i, j) = value(i, j);
      if (j < d.nodes) {
        blocks.nodes(j, i) = blocks.nodes(i, j);
      }
    }
  }
  for (Index j = 0; j < lights; ++j) {
    for (Index i = 0; i < d.views; ++i) {
      blocks.pairs(i, j) = value(d.nodes + i, d.nodes + d.views + j);
    }
  }
  return blocks;
}

/// The blocks of a' b, for `a` and `b` with a column for each direction.
template <typename Left, typename Right>
KernelBlocks product_blocks(const Directions& d, const Left& a, const Right& b) {
  const Index lights = d.targets - d.views;
  KernelBlocks blocks;
  blocks.nodes.noalias() = a.leftCols(d.nodes).transpose() * b;
  blocks.pairs.noalias() = a.middleCols(d.nodes, d.views).transpose() * b.rightCols(lights);
  return blocks;
}

/// PhaseKernel by blocks: moments of phase functions between directions.
class PhaseBlocks {
 public:
  PhaseBlocks(const Directions& d, int order, int count) : directions_(d), order_(order) {
    const Eigen::MatrixXd legendre = associated_legendre(order, count, d.mu);
    for (Index parity = 0; parity < 2; ++parity) {
      const Index terms = (legendre.rows() - parity + 1) / 2;
      Eigen::MatrixXd& rows = parity == 0 ? even_ : odd_;
      rows.resize(std::max<Index>(terms, 0), d.size());
      for (Index k = 0; k < terms; ++k) {
        rows.row(k) = legendre.row(2 * k + parity);
      }
    }
  }

  /// The kernels of a medium's single scattering, [node, direction].
  struct Pair {
    Eigen::MatrixXd turned;
    Eigen::MatrixXd passed;
  };
  Pair of(const TruncatedMedium& medium) const {
    const Eigen::MatrixXd even = share(medium, even_, 0);
    const Eigen::MatrixXd odd = share(medium, odd_, 1);
    // P_l^m(-mu) = (-1)^(l-m) P_l^m(mu).
    return {even - odd, even + odd};
  }

 private:
  Eigen::MatrixXd share(const TruncatedMedium& medium, const Eigen::MatrixXd& rows, Index parity) const {
    Eigen::VectorXd factors(rows.rows());
    for (Index k = 0; k < factors.size(); ++k) {
      const Index l = order_ + 2 * k + parity;
      factors[k] =
          0.25 * medium.albedo * (2.0 * static_cast<double>(l) + 1.0) * medium.moments[static_cast<std::size_t>(l)];
    }
    return rows.leftCols(directions_.nodes).transpose() * (factors.asDiagonal() * rows);
  }

  const Directions& directions_;
  Index order_;
  Eigen::MatrixXd even_;
  Eigen::MatrixXd odd_;
};

/// One order of a medium: all scattering to and from nodes, but only multiple scattering between a view and a light.
/// Joins carry the blocks between views and lights through deltas alone, so the joined stack lacks exactly its single
/// scattering.
struct MediumKernels {
  KernelBlocks turned;
  KernelBlocks passed;

  MediumKernels(const Directions& d, const ViewLightGeometry::Medium& geometry, const PhaseBlocks::Pair& phase,
                const MultipleScattering& multiple, const TruncatedMedium& medium, const Eigen::MatrixXd& carry) {
    // Multiple scattering has the shape of single reflection on both sides.
    const auto repeated = [&](const Eigen::MatrixXd& smooth) -> KernelBlocks {
      if (smooth.size() == 0) {
        return {Eigen::MatrixXd::Zero(geometry.turned.nodes.rows(), geometry.turned.nodes.cols()),
                Eigen::MatrixXd::Zero(geometry.turned.pairs.rows(), geometry.turned.pairs.cols())};
      }
      const KernelBlocks rest = product_blocks(d, carry, (smooth * carry).eval());
      return {rest.nodes.cwiseProduct(geometry.turned.nodes), rest.pairs.cwiseProduct(geometry.turned.pairs)};
    };
    turned = repeated(multiple.reflect);
    passed = repeated(multiple.transmit);
    const Eigen::MatrixXd turned_once = phase.turned.cwiseProduct(geometry.turned.nodes);
    const Eigen::MatrixXd passed_once = phase.passed.cwiseProduct(geometry.passed.nodes);
    if (multiple.survival.size() > 0) {
      const Eigen::VectorXd factors =
          energy_factors(d, multiple, medium, (turned_once + passed_once).rightCols(d.targets),
                         (turned.nodes + passed.nodes).rightCols(d.targets));
      turned.nodes.rightCols(d.targets) *= factors.asDiagonal();
      passed.nodes.rightCols(d.targets) *= factors.asDiagonal();
    }
    turned.nodes += turned_once;
    passed.nodes += passed_once;
  }
};

}  // namespace

void KernelBlocks::write(DirectionOperator& target) const {
  const Index n = nodes.rows();
  const Index targets = nodes.cols() - n;
  target.kernel.topRows(n) = nodes;
  target.kernel.bottomLeftCorner(targets, n) = nodes.rightCols(targets).transpose();
  target.kernel.block(n, n + pairs.rows(), pairs.rows(), pairs.cols()) = pairs;
  target.kernel.block(n + pairs.rows(), n, pairs.cols(), pairs.rows()) = pairs.transpose();
}

ViewLightGeometry::ViewLightGeometry(const Solution& solution, const Eigen::VectorXd& views,
                                     const Eigen::VectorXd& lights)
    : directions_(
          solution.directions((Eigen::VectorXd(views.size() + lights.size()) << views, lights).finished()).front()) {
  directions_.views = views.size();
  const std::size_t count = solution.scatterers().size();
  std::vector<Eigen::VectorXd> through;
  for (const Solution::Scatterer& scatterer : solution.scatterers()) {
    const TruncatedMedium& medium = scatterer.medium;
    media_.push_back({shape_blocks(directions_, medium.tau, single_reflection),
                      shape_blocks(directions_, medium.tau, single_transmission),
                      Eigen::VectorXd::Ones(directions_.size()), Eigen::VectorXd::Ones(directions_.size())});
    through.push_back(direct_transmissions(directions_.mu, medium.tau));
  }
  for (std::size_t layer = 1; layer < count; ++layer) {
    media_[layer].above = media_[layer - 1].above.cwiseProduct(through[layer - 1]);
  }
  if (solution.stack().base.kind != Base::Kind::kNone && count > 0) {
    media_.back().below.setZero();
  }
  for (std::size_t layer = count; layer-- > 1;) {
    media_[layer - 1].below = media_[layer].below.cwiseProduct(through[layer]);
  }
}

ViewLightOrder::ViewLightOrder(const Solution& solution, const ViewLightGeometry& geometry, int order) {
  const Directions& d = geometry.directions();
  const bool opaque = solution.stack().base.kind != Base::Kind::kNone;
  const std::size_t count = solution.scatterers().size();
  const PhaseBlocks phases(d, order, solution.resolution().moments());
  Eigen::MatrixXd carry = d.interpolation.transpose();
  if (order % 2 == 1) {
    carry *= (1.0 - d.mu.array().square()).max(0.0).sqrt().matrix().asDiagonal();
  }
  const Index lights = d.targets - d.views;
  const auto pairs = [&](const DirectionOperator& operation) {
    return operation.kernel.block(d.nodes, d.nodes + d.views, d.views, lights);
  };

  // Join from the bottom up. Over an opaque base only reflections from above are needed.
  whole =
      opaque ? ScatteringFunction::lambert(solution.stack().base.reflectance, order, d) : ScatteringFunction::empty(d);
  bool reflects = opaque && order == 0 && solution.stack().base.reflectance > 0.0;
  for (std::size_t layer = count; layer-- > 0;) {
    const ViewLightGeometry::Medium& medium = geometry.media()[layer];
    const TruncatedMedium& optics = solution.scatterers()[layer].medium;
    const MediumKernels kernels(d, medium, phases.of(optics), solution.multiple(order, layer), optics, carry);
    ScatteringFunction single = ScatteringFunction::empty(d);
    kernels.turned.write(single.reflect_above);
    kernels.turned.write(single.reflect_below);
    kernels.passed.write(single.transmit);
    single.transmit.delta = direct_transmissions(d.mu, optics.tau);
    if (opaque) {
      whole.reflect_above = reflects ? join_opaque(single, whole.reflect_above) : single.reflect_above;
    } else {
      whole = layer + 1 == count ? single : join(single, whole);
    }
    reflects = true;
  }
  above = pairs(whole.reflect_above);
  below = pairs(whole.reflect_below);
  downward = pairs(whole.transmit);
  upward = whole.transmit.kernel.block(d.nodes + d.views, d.nodes, lights, d.views).transpose();
}

}  // namespace lamina
