// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/interface.hpp"

#include <algorithm>

#include "matter/smooth_boundary.hpp"

namespace lamina {

ScatteringFunction smooth_interface(const Directions& above, const Directions& below, const FacetOptics& optics) {
  ScatteringFunction s = ScatteringFunction::bare(above.size(), above.nodes);
  const Eigen::Index common = std::min(above.live, below.live);
  for (Eigen::Index node = common; node < above.live; ++node) {
    s.reflect_above.delta[node] = SmoothBoundary(optics, above.mu[node], 0.0).above;
  }
  for (Eigen::Index node = common; node < below.live; ++node) {
    s.reflect_below.delta[node] = SmoothBoundary(optics, 0.0, below.mu[node]).below;
  }
  const auto set = [&](Eigen::Index direction, Eigen::Index at_above, Eigen::Index at_below) {
    const SmoothBoundary boundary(optics, above.mu[at_above], below.mu[at_below]);
    s.reflect_above.delta[direction] = boundary.above;
    s.reflect_below.delta[direction] = boundary.below;
    s.transmit.delta[direction] = boundary.passed;
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
