// SPDX-License-Identifier: GPL-3.0-or-later
#include "table/media_slices.hpp"

#include <cmath>
#include <numbers>

namespace lamina {

using Eigen::Index;
using std::numbers::pi;

std::vector<Eigen::MatrixXd> MediaSlices::order(int m) {
  ViewLightOrder solved(solution_, geometry_, m);
  std::vector<Eigen::MatrixXd> seen;
  for (const Sight& sight : sights_) {
    const bool top = sight.viewer == Side::kTop;
    seen.push_back(sight.path == Path::kReflect ? (top ? solved.above : solved.below)
                                                : (top ? solved.upward : solved.downward));
  }
  if (m == 0) {
    zeroth_ = std::make_unique<ScatteringFunction>(std::move(solved.whole));
  }
  return seen;
}

SliceSource::Shares MediaSlices::shares(const Sight& sight) const {
  const Directions& d = geometry_.directions();
  const Index views = grid_.view_mu.size();
  const bool top = sight.viewer == Side::kTop;
  // A target has no factor C in its scale: the sum over nodes of pi f (2 mu w) remains.
  const Eigen::VectorXd sums = d.scale.head(d.nodes);
  if (sight.path == Path::kReflect) {
    const DirectionOperator& reflect = top ? zeroth_->reflect_above : zeroth_->reflect_below;
    return {reflect.kernel.block(d.nodes, 0, views, d.nodes) * sums, Eigen::VectorXd::Zero(views)};
  }
  // By reciprocity, the light seen from a side is the flux of a beam from that side.
  Shares shares{top ? (zeroth_->transmit.kernel.block(0, d.nodes, d.nodes, views).transpose() * sums).eval()
                    : (zeroth_->transmit.kernel.block(d.nodes, 0, views, d.nodes) * sums).eval(),
                Eigen::VectorXd::Zero(views)};
  if (solution_.stack().base.kind == Base::Kind::kNone) {
    // The direct beam is that of the untruncated thickness; the difference counts as scattered.
    double tau = 0.0;
    for (const Layer& layer : solution_.stack().layers) {
      tau += std::get<Medium>(layer).tau;
    }
    shares.direct = direct_transmissions(grid_.view_mu, tau);
    shares.albedo += zeroth_->transmit.delta.segment(d.nodes, views) - shares.direct;
  }
  return shares;
}

void MediaSlices::add_once(const Sight& sight, Index view, Slice slice) const {
  for (std::size_t layer = 0; layer < geometry_.media().size(); ++layer) {
    add_medium(sight, view, layer, slice);
  }
}

void MediaSlices::add_medium(const Sight& sight, Index view, std::size_t layer, Slice& slice) const {
  const Directions& d = geometry_.directions();
  const ViewLightGeometry::Medium& medium = geometry_.media()[layer];
  const bool reflects = sight.path == Path::kReflect;
  const Eigen::VectorXd& out = sight.viewer == Side::kTop ? medium.above : medium.below;
  const Eigen::VectorXd& in = sight.entry() == Side::kTop ? medium.above : medium.below;
  const double weight =
      0.25 / pi * solution_.scatterers()[layer].medium.single_scattering_albedo() * out[d.nodes + view];
  const Eigen::MatrixXd& shape = reflects ? medium.turned.pairs : medium.passed.pairs;
  const double mu_o = grid_.view_mu[view];
  const Eigen::ArrayXd azimuth = grid_.dphi.array().cos();
  Eigen::ArrayXd phase(azimuth.size());
  for (Index i = 0; i < slice.rows(); ++i) {
    const double mu_i = grid_.light_mu[i];
    const double strength = weight * shape(view, i) * in[d.nodes + d.views + i];
    if (strength == 0.0) {
      continue;
    }
    phase = std::sqrt((1.0 - mu_o * mu_o) * (1.0 - mu_i * mu_i)) * azimuth + (reflects ? -1.0 : 1.0) * mu_o * mu_i;
    solution_.scatterers()[layer].phase.evaluate_all(phase);
    slice.row(i) += strength * phase.matrix().transpose();
  }
}

}  // namespace lamina
