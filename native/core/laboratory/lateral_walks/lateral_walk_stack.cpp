// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral_walks/lateral_walk_stack.hpp"

#include <cmath>
#include <stdexcept>

namespace lamina {

LateralWalkStack::LateralWalkStack(const Stack& stack, std::vector<DepthScale> layer_scales)
    : walked(stack, WalkTarget{}), scales(std::move(layer_scales)) {
  if (scales.size() != stack.layers.size()) {
    throw std::invalid_argument("scales: must have one entry per layer");
  }
  scales.resize(walked.elements.size());
  for (std::size_t k = 0; k < stack.layers.size(); ++k) {
    const auto* medium = std::get_if<Medium>(&stack.layers[k]);
    if (medium != nullptr && std::isinf(medium->tau)) {
      if (medium->albedo == 1.0) {
        const double transport = 1.0 / (scales[k].knots().front().sigma_t * (1.0 - medium->phase.moment(1)));
        spread = 4.0 / 3.0 * transport;
      }
      return;
    }
  }
}

}  // namespace lamina
