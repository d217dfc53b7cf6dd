// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/sublayer_stack.hpp"

#include "matter/graded_sublayers.hpp"

namespace lamina {

SublayerStack::SublayerStack(const Stack& given, const std::vector<double>& coarseness) {
  stack.base = given.base;
  double ior = 1.0;
  for (std::size_t layer = 0; layer < given.layers.size(); ++layer) {
    first.push_back(stack.layers.size());
    if (const auto* interface = std::get_if<Interface>(&given.layers[layer])) {
      if (!interface->reflects(ior)) {
        continue;
      }
      ior = interface->ior;
    }
    const auto* graded = std::get_if<GradedMedium>(&given.layers[layer]);
    if (graded == nullptr) {
      stack.layers.push_back(given.layers[layer]);
      share.push_back(1.0);
      continue;
    }
    for (const Medium& sublayer : sublayers_of(*graded, coarseness.at(layer))) {
      stack.layers.emplace_back(sublayer);
      share.push_back(sublayer.tau / graded->tau());
    }
  }
  first.push_back(stack.layers.size());
}

}  // namespace lamina
