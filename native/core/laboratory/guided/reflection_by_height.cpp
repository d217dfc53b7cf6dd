// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/reflection_by_height.hpp"

#include <algorithm>

#include "operators/adding.hpp"

namespace lamina {

int guide_nodes(const GradedMedium& medium) {
  double peak = 0.0;
  for (const GradedMedium::Knot& knot : medium.knots()) {
    peak = std::max(peak, knot.phase.peak());
  }
  return peak > 0.85 ? 24 : peak > 0.4 ? 16 : 12;
}

ReflectionByHeight::ReflectionByHeight(const GradedMedium& medium, std::vector<double> heights, int nodes,
                                       const Eigen::VectorXd& targets)
    : medium_(medium),
      heights_(std::move(heights)),
      directions_(DirectionSet({1.0}, nodes, {}).in_medium(1.0, targets)) {}

TruncatedMedium ReflectionByHeight::medium(double height, double tau) const {
  const LocalScattering local = medium_.at(height);
  const double albedo = local.albedo();
  const double share = albedo > 0.0 ? local.first / albedo : 1.0;
  const int count = orders();
  const auto moment = [&](int l) { return share * local.p->moment(l) + (1.0 - share) * local.q->moment(l); };
  TruncatedMedium seen(Medium{albedo, tau, PhaseFunction()}, count);
  const double f = moment(count);
  for (int l = 0; l < count; ++l) {
    seen.moments[static_cast<std::size_t>(l)] = (moment(l) - f) / (1.0 - f);
  }
  seen.forward_share = f;
  seen.albedo = albedo * (1.0 - f) / (1.0 - albedo * f);
  seen.tau = tau * (1.0 - albedo * f);
  return seen;
}

std::vector<Eigen::MatrixXd> ReflectionByHeight::order(int m) const {
  std::vector<Eigen::MatrixXd> all;
  // S = 4 mu mu0 pi f, where f is the BRDF.
  const Eigen::VectorXd unscaled = 2.0 * directions_.mu.cwiseQuotient(directions_.scale);
  const auto keep = [&](const Eigen::MatrixXd& kernel) {
    all.push_back(unscaled.asDiagonal() * kernel * unscaled.asDiagonal());
  };
  if (medium_.is_homogeneous() && medium_.ground() == 0.0) {
    const double whole = medium_.tau();
    const TruncatedMedium seen = medium(0.0, whole);
    const HomogeneousModes modes(seen, m, directions_);
    const PhaseKernel phase(seen, m, directions_.mu.head(directions_.live));
    for (const double t : heights_) {
      const TruncatedMedium part = medium(0.0, t);
      const MultipleScattering multiple = multiple_scattering(modes.layer(part.tau), part, phase, m, directions_);
      const LayerShapes shapes(directions_, part);
      keep(multiple_on(directions_, multiple, part, shapes, m).reflect +
           single_on(directions_, part, shapes, m).reflect);
    }
    return all;
  }
  double below = 0.0;
  DirectionOperator reflect = ScatteringFunction::lambert(medium_.ground(), m, directions_).reflect_above;
  for (const double t : heights_) {
    const TruncatedMedium seen = medium(0.5 * (below + t), t - below);
    const PhaseKernel phase(seen, m, directions_.mu.head(directions_.live));
    const LayerShapes shapes(directions_, seen);
    const auto modes = [&] { return HomogeneousModes(seen, m, directions_); };
    reflect = join_opaque(layer(m, seen, phase, shapes, modes), reflect);
    keep(reflect.kernel);
    below = t;
  }
  return all;
}

}  // namespace lamina
