// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/base_reflection.hpp"

namespace lamina {

ScatteringFunction base_deltas(const Base& base, const Directions& above) {
  ScatteringFunction s = ScatteringFunction::bare(above.size(), above.nodes);
  if (base.has_mirror()) {
    const Eigen::VectorXd reflected =
        above.mu.unaryExpr([&](double mu) { return base.mirror_reflectance(mu, above.ior); });
    s.reflect_above.delta = above.spread(reflected);
  }
  return s;
}

ScatteringFunction base_reflection(const Base& base, int order, const Directions& above) {
  ScatteringFunction s = base_deltas(base, above);
  if (base.is_diffuse() && order == 0) {
    const Eigen::VectorXd leaving =
        above.mu.unaryExpr([&](double mu) { return base.diffuse_reflectance(mu); }).cwiseProduct(above.scale);
    s.reflect_above.kernel = above.spread((leaving * above.scale.transpose()).eval());
  }
  return s;
}

}  // namespace lamina
