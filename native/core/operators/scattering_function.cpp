// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/scattering_function.hpp"

#include <utility>

namespace lamina {

ScatteringFunction ScatteringFunction::reversed() const {
  return {reflect_below, transmit.transposed(), reflect_above};
}

ScatteringFunction ScatteringFunction::nothing(Eigen::Index size, Eigen::Index nodes, Eigen::Index views) {
  return {DirectionOperator::zero(size, nodes, views), DirectionOperator::zero(size, nodes, views),
          DirectionOperator::zero(size, nodes, views)};
}

ScatteringFunction ScatteringFunction::bare(Eigen::Index size, Eigen::Index nodes) {
  const DirectionOperator none{Eigen::MatrixXd(), Eigen::VectorXd::Zero(size), nodes};
  return {none, none, none};
}

ScatteringFunction ScatteringFunction::with_kernels() && {
  for (DirectionOperator* part : {&reflect_above, &transmit, &reflect_below}) {
    if (!part->has_kernel()) {
      part->kernel.setZero(part->delta.size(), part->delta.size());
    }
  }
  return std::move(*this);
}

ScatteringFunction ScatteringFunction::empty(const Directions& directions) {
  ScatteringFunction s = nothing(directions.size(), directions.nodes, directions.views);
  s.transmit.delta.setOnes();
  return s;
}

ScatteringFunction ScatteringFunction::lambert(double reflectance, int order, const Directions& directions) {
  ScatteringFunction s = nothing(directions.size(), directions.nodes, directions.views);
  if (order == 0) {
    s.reflect_above.kernel = directions.spread((reflectance * directions.scale * directions.scale.transpose()).eval());
  }
  return s;
}

}  // namespace lamina
