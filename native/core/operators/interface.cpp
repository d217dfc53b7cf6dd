// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/interface.hpp"

#include <algorithm>

#include "matter/fresnel.hpp"

namespace lamina {

ScatteringFunction smooth_interface(const Directions& above, const Directions& below) {
  ScatteringFunction s = ScatteringFunction::bare(above.size(), above.nodes);
  const Eigen::Index common = std::min(above.live, below.live);
  s.reflect_above.delta.head(above.live).tail(above.live - common).setOnes();
  s.reflect_below.delta.head(below.live).tail(below.live - common).setOnes();
  const auto set = [&](Eigen::Index direction, Eigen::Index at_above, Eigen::Index at_below) {
    const double reflected = fresnel(above.mu[at_above], below.mu[at_below], above.ior, below.ior);
    s.reflect_above.delta[direction] = s.reflect_below.delta[direction] = reflected;
    s.transmit.delta[direction] = 1.0 - reflected;
  };
  for (Eigen::Index node = 0; node < common; ++node) {
    set(node, node, node);
  }
  for (Eigen::Index t = 0; t < above.targets; ++t) {
    set(above.nodes + t, above.live + t, below.live + t);
  }
  return s;
}

}  // namespace lamina
