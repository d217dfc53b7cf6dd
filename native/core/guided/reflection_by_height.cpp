// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/reflection_by_height.hpp"

#include "operators/adding.hpp"

namespace lamina {

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

ScatteringFunction ReflectionByHeight::layer(int m, double height, double tau) const {
  const TruncatedMedium seen = medium(height, tau);
  const PhaseKernel phase(seen, m, directions_.mu.head(directions_.live));
  const LayerShapes shapes(directions_, seen.tau);
  // Where hardly anything is scattered twice, rounding would show instead.
  constexpr double kFaintest = 1e-7;
  const Eigen::Index n = directions_.live;
  const MultipleScattering multiple =
      seen.albedo * seen.tau > kFaintest
          ? multiple_scattering(HomogeneousModes(seen, m, directions_).layer(seen.tau), seen, phase, m, directions_)
          : MultipleScattering{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd()};
  return layer_on(directions_, multiple, seen, shapes, single_on(directions_, seen, shapes, m), m);
}

std::vector<Eigen::MatrixXd> ReflectionByHeight::order(int m) const {
  std::vector<Eigen::MatrixXd> all;
  // S = 4 mu mu0 pi f.
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
      const LayerShapes shapes(directions_, part.tau);
      keep(multiple_on(directions_, multiple, part, shapes, m).reflect +
           single_on(directions_, part, shapes, m).reflect);
    }
    return all;
  }
  double below = 0.0;
  DirectionOperator reflect = ScatteringFunction::lambert(medium_.ground(), m, directions_).reflect_above;
  for (const double t : heights_) {
    reflect = join_opaque(layer(m, 0.5 * (below + t), t - below), reflect);
    keep(reflect.kernel);
    below = t;
  }
  return all;
}

}  // namespace lamina
