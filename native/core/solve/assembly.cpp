// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/assembly.hpp"

#include "operators/adding.hpp"
#include "operators/base_reflection.hpp"
#include "operators/interface.hpp"

namespace lamina {

Assembly::Assembly(const Solution& solution, const Eigen::VectorXd& targets, ThreadPool& pool, Eigen::Index views)
    : solution_(solution), directions_(solution.directions(targets)) {
  for (Directions& directions : directions_) {
    directions.views = views;
  }
  for (const Solution::Boundary& boundary : solution.boundaries()) {
    const bool at_base = boundary.layer == solution.stack().layers.size();
    const Directions& below = directions_[at_base ? boundary.layer : boundary.layer + 1];
    surfaces_.push_back(boundary.surface->on(directions_[boundary.layer], below, pool));
  }
  for (const Solution::Scatterer& scatterer : solution.scatterers()) {
    shapes_.emplace_back(directions_[scatterer.layer], scatterer.medium);
  }
  deltas_ = DeltaField(layers(0, nullptr));
}

Assembly::Assembly(const Solution& solution, const Eigen::VectorXd& targets)
    : solution_(solution), directions_(solution.directions(targets)) {
  deltas_ = DeltaField(layers(0, nullptr));
}

std::vector<LayerKernels> Assembly::once(int order) const {
  std::vector<LayerKernels> kernels;
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    const Solution::Scatterer& scatterer = solution_.scatterers()[k];
    kernels.push_back(single_on(directions_[scatterer.layer], scatterer.medium, shapes_[k], order));
  }
  return kernels;
}

std::vector<ScatteringFunction> Assembly::layers(int order, const std::vector<LayerKernels>* once) const {
  const bool kernels = once != nullptr;
  const Stack& stack = solution_.stack();
  std::vector<ScatteringFunction> functions;
  std::size_t scatterer = 0;
  std::size_t surface = 0;
  const auto rough = [&](const Directions& here) {
    functions.push_back(kernels ? surfaces_[surface].order(order) : ScatteringFunction::bare(here.size(), here.nodes));
    ++surface;
  };
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    const Directions& here = directions_[layer];
    if (const auto* interface = std::get_if<Interface>(&stack.layers[layer])) {
      if (interface->is_rough(here.ior)) {
        rough(here);
      } else {
        functions.push_back(smooth_interface(here, directions_[layer + 1], interface->optics(here.ior)));
      }
      continue;
    }
    const TruncatedMedium& medium = solution_.scatterers()[scatterer].medium;
    const MultipleScattering& multiple = solution_.multiple(order, scatterer);
    if (kernels && !(multiple.reflect.size() == 0 && (*once)[scatterer].reflect.isZero(0.0))) {
      functions.push_back(layer_on(here, multiple, medium, shapes_[scatterer], (*once)[scatterer], order));
    } else {
      ScatteringFunction direct = ScatteringFunction::bare(here.size(), here.nodes);
      direct.transmit.delta = here.spread(direct_transmissions(here.mu, medium));
      functions.push_back(std::move(direct));
    }
    ++scatterer;
  }
  const Base& base = stack.base;
  const Directions& bottom = directions_.back();
  if (base.kind != Base::Kind::kNone) {
    functions.push_back(kernels ? base_reflection(base, order, bottom) : base_deltas(base, bottom));
    if (base.is_rough() && kernels) {
      ScatteringFunction& whole = functions.back();
      whole.reflect_above = std::move(whole.reflect_above) + surfaces_[surface].order(order).reflect_above;
    }
  }
  for (ScatteringFunction& function : functions) {
    for (DirectionOperator* part : {&function.reflect_above, &function.transmit, &function.reflect_below}) {
      part->views = bottom.views;
    }
  }
  return functions;
}

ScatteringFunction Assembly::joined(int order, const std::vector<LayerKernels>& once, bool between_targets) const {
  std::vector<ScatteringFunction> functions = layers(order, &once);
  if (functions.empty()) {
    return ScatteringFunction::empty(directions_.front());
  }
  ScatteringFunction whole = std::move(functions.back());
  functions.pop_back();
  if (between_targets && !functions.empty()) {
    // Light comes in from targets at the top and at the bottom, and leaves towards targets.
    functions.front().transmit.from_targets = true;
    whole.transmit.to_targets = true;
    whole.reflect_below.to_targets = true;
    whole.reflect_below.from_targets = true;
  }
  const bool opaque = solution_.stack().base.kind != Base::Kind::kNone;
  for (std::size_t k = functions.size(); k-- > 0;) {
    if (opaque) {
      whole.reflect_above = join_opaque(functions[k], whole.reflect_above);
    } else {
      whole = join(functions[k], whole);
    }
  }
  return std::move(whole).with_kernels();
}

ScatteringFunction Assembly::without_single(int order) const {
  const Stack& stack = solution_.stack();
  const std::vector<Solution::Scatterer>& scatterers = solution_.scatterers();
  const bool base_reflects = stack.base.is_glossy() || (stack.base.is_diffuse() && order == 0);
  if (stack.layers.size() == 1 && scatterers.size() == 1 && !base_reflects) {
    // A single medium: the assembly is its multiple scattering.
    const Directions& here = directions_.front();
    const LayerKernels alone =
        multiple_on(here, solution_.multiple(order, 0), scatterers.front().medium, shapes_[0], order);
    ScatteringFunction rest = ScatteringFunction::nothing(here.size(), here.nodes);
    rest.reflect_above.kernel = alone.reflect;
    if (stack.base.kind == Base::Kind::kNone) {
      rest.reflect_below.kernel = alone.reflect;
      rest.transmit.kernel = alone.transmit;
    }
    return rest;
  }
  // A join carries kernels between two targets through deltas alone. Without those of single scattering the stack lacks
  // exactly its single scattering.
  std::vector<LayerKernels> single = once(order);
  for (std::size_t k = 0; k < scatterers.size(); ++k) {
    const Eigen::Index targets = directions_[scatterers[k].layer].targets;
    single[k].reflect.bottomRightCorner(targets, targets).setZero();
    single[k].transmit.bottomRightCorner(targets, targets).setZero();
  }
  ScatteringFunction rest = joined(order, single, true);
  rest.reflect_above.delta.setZero();
  rest.reflect_below.delta.setZero();
  rest.transmit.delta.setZero();
  const bool opaque = stack.base.kind != Base::Kind::kNone;
  if (opaque) {
    rest.reflect_below.kernel.setZero();
    rest.transmit.kernel.setZero();
  }
  return rest;
}

}  // namespace lamina
