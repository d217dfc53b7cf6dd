// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/specular_paths.hpp"

#include "operators/interface.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

/// The delta parts of each layer and of the base, for the targets.
std::vector<Deltas> deltas_of(const OrientedSolution& solution, const std::vector<Directions>& gaps) {
  const Stack& stack = solution.stack();
  const Index targets = gaps.front().targets;
  std::vector<Deltas> own;
  std::size_t scatterer = 0;
  for (std::size_t layer = 0; layer <= stack.layers.size(); ++layer) {
    Deltas here{ArrayXd::Zero(targets), ArrayXd::Zero(targets), ArrayXd::Zero(targets)};
    if (layer == stack.layers.size()) {
      if (stack.base.kind == Base::Kind::kNone) {
        break;
      }
      if (stack.base.is_mirror()) {
        here.reflect_above = gaps[layer].mu.tail(targets).array().unaryExpr(
            [&](double mu) { return stack.base.mirror_reflectance(mu, gaps[layer].ior); });
      }
    } else if (const auto* interface = std::get_if<Interface>(&stack.layers[layer])) {
      if (solution.surface(layer) == nullptr) {
        const ScatteringFunction s = smooth_interface(gaps[layer], gaps[layer + 1], interface->optics(gaps[layer].ior));
        here = {s.reflect_above.delta.tail(targets), s.transmit.delta.tail(targets),
                s.reflect_below.delta.tail(targets)};
      }
    } else {
      here.transmit =
          direct_transmissions(gaps[layer].mu.tail(targets), solution.media().scatterers()[scatterer++].medium.tau);
    }
    own.push_back(std::move(here));
  }
  return own;
}

}  // namespace

SpecularPaths::SpecularPaths(const OrientedSolution& solution, const VectorXd& cosines)
    : solution_(&solution), gaps_(solution.directions(cosines)), deltas_(deltas_of(solution, gaps_)) {}

double SpecularPaths::by_facets(const Arrived& out, const Arrived& in, std::size_t layer) const {
  double sum = 0.0;
  over_faces(layer, out, in, [&](Face from, Face to, double share) {
    sum += share * solution_->surface(layer)->once(from, to, heading(in, from == Face::kTop ? layer : layer + 1),
                                                   heading(out, to == Face::kTop ? layer : layer + 1));
  });
  return sum;
}

Deltas specular_light(const OrientedSolution& solution, const VectorXd& mu) {
  Deltas whole = Deltas::nothing(mu.size());
  for (const Deltas& one : deltas_of(solution, solution.directions(mu))) {
    whole = joined(whole, one);
  }
  return whole;
}

}  // namespace lamina
