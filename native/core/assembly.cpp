// SPDX-License-Identifier: GPL-3.0-or-later
#include "assembly.hpp"

#include "adding.hpp"
#include "interface.hpp"

namespace lamina {

Assembly::Assembly(const Solution& solution, const Eigen::VectorXd& targets, ThreadPool& pool)
    : solution_(solution), directions_(solution.directions(targets)) {
  for (const Solution::Boundary& boundary : solution.boundaries()) {
    const bool at_base = boundary.layer == solution.stack().layers.size();
    const Directions& below = directions_[at_base ? boundary.layer : boundary.layer + 1];
    surfaces_.push_back(boundary.surface->on(directions_[boundary.layer], below, pool));
  }
  deltas_ = DeltaField(layers(0, false));
}

Assembly::Assembly(const Solution& solution, const Eigen::VectorXd& targets)
    : solution_(solution), directions_(solution.directions(targets)) {
  deltas_ = DeltaField(layers(0, false));
}

std::vector<ScatteringFunction> Assembly::layers(int order, bool kernels) const {
  const Stack& stack = solution_.stack();
  std::vector<ScatteringFunction> functions;
  std::size_t scatterer = 0;
  std::size_t surface = 0;
  const auto rough = [&](const Directions& here) {
    functions.push_back(kernels ? surfaces_[surface][static_cast<std::size_t>(order)]
                                : ScatteringFunction::bare(here.size(), here.nodes));
    ++surface;
  };
  const auto push_smooth = [&](ScatteringFunction deltas) {
    functions.push_back(kernels ? deltas.with_zero_kernels() : std::move(deltas));
  };
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    const Directions& here = directions_[layer];
    if (const auto* interface = std::get_if<Interface>(&stack.layers[layer])) {
      if (interface->is_rough(here.ior)) {
        rough(here);
      } else {
        push_smooth(smooth_interface(here, directions_[layer + 1]));
      }
      continue;
    }
    const TruncatedMedium& medium = solution_.scatterers()[scatterer].medium;
    if (kernels) {
      functions.push_back(layer_on(here, solution_.multiple(order, scatterer), medium, order));
    } else {
      ScatteringFunction direct = ScatteringFunction::bare(here.size(), here.nodes);
      direct.transmit.delta = here.spread(direct_transmissions(here.mu, medium.tau));
      functions.push_back(std::move(direct));
    }
    ++scatterer;
  }
  const Base& base = stack.base;
  const Directions& bottom = directions_.back();
  if (base.kind == Base::Kind::kLambert) {
    functions.push_back(kernels ? ScatteringFunction::lambert(base.reflectance, order, bottom)
                                : ScatteringFunction::bare(bottom.size(), bottom.nodes));
  } else if (base.kind == Base::Kind::kConductor && base.facets.alpha > 0.0) {
    rough(bottom);
  } else if (base.kind == Base::Kind::kConductor) {
    push_smooth(smooth_conductor(base.ior, bottom));
  }
  return functions;
}

ScatteringFunction Assembly::joined(int order) const {
  const std::vector<ScatteringFunction> functions = layers(order, true);
  if (functions.empty()) {
    return ScatteringFunction::empty(directions_.front());
  }
  ScatteringFunction whole = functions.back();
  for (std::size_t k = functions.size() - 1; k-- > 0;) {
    whole = join(functions[k], whole);
  }
  return whole;
}

ScatteringFunction Assembly::without_single(int order) const {
  const Stack& stack = solution_.stack();
  const std::vector<Solution::Scatterer>& scatterers = solution_.scatterers();
  const bool base_reflects = stack.base.kind == Base::Kind::kConductor ||
                             (stack.base.kind == Base::Kind::kLambert && order == 0 && stack.base.reflectance > 0.0);
  if (stack.layers.size() == 1 && scatterers.size() == 1 && !base_reflects) {
    // One medium alone: what is wanted is what was solved.
    const Directions& here = directions_.front();
    const LayerKernels alone = multiple_on(here, solution_.multiple(order, 0), scatterers.front().medium, order);
    ScatteringFunction rest = ScatteringFunction::nothing(here.size(), here.nodes);
    rest.reflect_above.kernel = alone.reflect;
    if (stack.base.kind == Base::Kind::kNone) {
      rest.reflect_below.kernel = alone.reflect;
      rest.transmit.kernel = alone.transmit;
    }
    return rest;
  }
  ScatteringFunction rest = joined(order);
  rest.reflect_above.delta.setZero();
  rest.reflect_below.delta.setZero();
  rest.transmit.delta.setZero();
  for (const Solution::Scatterer& scatterer : scatterers) {
    const LayerKernels once = single_on(directions_[scatterer.layer], scatterer.medium, order);
    const Eigen::MatrixXd turned = directions_[scatterer.layer].spread(once.reflect);
    const Eigen::MatrixXd passed = directions_[scatterer.layer].spread(once.transmit);
    const DeltaField::Arrival& above = deltas_.from_above[scatterer.layer];
    const DeltaField::Arrival& below = deltas_.from_below[scatterer.layer];
    // Out of each face, light that arrived at either.
    const auto between = [&](const DeltaField::Arrival& out, const DeltaField::Arrival& in) -> Eigen::MatrixXd {
      return out.down.asDiagonal() * turned * in.down.asDiagonal() + out.up.asDiagonal() * turned * in.up.asDiagonal() +
             out.down.asDiagonal() * passed * in.up.asDiagonal() + out.up.asDiagonal() * passed * in.down.asDiagonal();
    };
    rest.reflect_above.kernel -= between(above, above);
    rest.reflect_below.kernel -= between(below, below);
    rest.transmit.kernel -= between(below, above);
  }
  if (stack.base.kind != Base::Kind::kNone) {
    rest.reflect_below.kernel.setZero();
    rest.transmit.kernel.setZero();
  }
  return rest;
}

}  // namespace lamina
