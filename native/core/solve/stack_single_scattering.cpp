// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/stack_single_scattering.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "matter/single_scattering_shape.hpp"

namespace lamina {

using Eigen::ArrayXd;
using Eigen::Index;
using std::numbers::pi;

StackSingleScattering::StackSingleScattering(const Assembly& assembly, Side side, Path path) {
  const Solution& solution = assembly.solution();
  const bool leaves_above = (side == Side::kTop) == (path == Path::kReflect);
  const auto term = [&](std::size_t layer) {
    const Directions& here = assembly.directions()[layer];
    const auto& above = assembly.deltas().from_above[layer];
    const auto& below = assembly.deltas().from_below[layer];
    const auto& in = side == Side::kTop ? above : below;
    const auto& out = leaves_above ? above : below;
    const Index count = here.targets;
    return Term{here.mu.tail(count), in.down.tail(count), in.up.tail(count), out.down.tail(count), out.up.tail(count)};
  };
  for (const Solution::Scatterer& scatterer : solution.scatterers()) {
    Medium medium{term(scatterer.layer), &scatterer,
                  0.25 / pi * scatterer.medium.single_scattering_albedo() / (scatterer.ior * scatterer.ior)};
    media_.push_back(std::move(medium));
  }
  for (const Solution::Boundary& boundary : solution.boundaries()) {
    const std::size_t below = std::min(boundary.layer + 1, assembly.directions().size() - 1);
    const Directions& beyond = assembly.directions()[below];
    facets_.push_back({term(boundary.layer), beyond.mu.tail(beyond.targets), boundary.surface.get()});
  }
}

ArrayXd StackSingleScattering::by_media(Index o, Index i, const ArrayXd& cosines) const {
  ArrayXd sum = ArrayXd::Zero(cosines.size());
  for (const Medium& m : media_) {
    const double mu_o = m.at.mu[o];
    const double mu_i = m.at.mu[i];
    const TruncatedMedium& optics = m.scatterer->medium;
    const auto add = [&](double share, double turn, double shape) {
      sum += m.weight * share * shape * m.scatterer->phase_of(mu_o, mu_i, turn, cosines);
    };
    const double turned = m.at.out_down[o] * m.at.in_down[i] + m.at.out_up[o] * m.at.in_up[i];
    const double passed = m.at.out_down[o] * m.at.in_up[i] + m.at.out_up[o] * m.at.in_down[i];
    if (turned > 0.0) {
      add(turned, -1.0, single_reflection(optics.optical(mu_o), optics.optical(mu_i), optics.tau));
    }
    if (passed > 0.0) {
      add(passed, 1.0, single_transmission(optics.optical(mu_o), optics.optical(mu_i), optics.tau));
    }
  }
  return sum;
}

ArrayXd StackSingleScattering::by_facets(Index o, Index i, const ArrayXd& cosines) const {
  ArrayXd sum = ArrayXd::Zero(cosines.size());
  for (const Facet& f : facets_) {
    for (const Face from : {Face::kTop, Face::kBottom}) {
      for (const Face to : {Face::kTop, Face::kBottom}) {
        const bool on_top = from == Face::kTop;
        const bool by_top = to == Face::kTop;
        const double share = (by_top ? f.at.out_down : f.at.out_up)[o] * (on_top ? f.at.in_down : f.at.in_up)[i];
        if (share > 0.0) {
          sum += share * f.surface->value(from, to, (on_top ? f.at.mu : f.mu_below)[i],
                                          (by_top ? f.at.mu : f.mu_below)[o], cosines);
        }
      }
    }
  }
  return sum;
}

}  // namespace lamina
