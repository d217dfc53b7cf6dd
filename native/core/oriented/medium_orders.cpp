// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/medium_orders.hpp"

#include "solve/homogeneous_layer.hpp"

namespace lamina {
namespace {

LayerKernels repeated_on(const Solution& media, std::size_t scatterer, const Directions& directions,
                         const LayerShapes& shapes, int order) {
  static const MultipleScattering none{};
  const bool solved = order < media.orders();
  return multiple_on(directions, solved ? media.multiple(order, scatterer) : none, media.scatterers()[scatterer].medium,
                     shapes, order);
}

}  // namespace

MediumOnNodes::MediumOnNodes(const Solution& media, std::size_t scatterer, const Directions& nodes, int orders) {
  const TruncatedMedium& medium = media.scatterers()[scatterer].medium;
  const LayerShapes shapes(nodes, medium);
  for (int m = 0; m < orders; ++m) {
    const LayerKernels repeated = repeated_on(media, scatterer, nodes, shapes, m);
    const LayerKernels once = single_on(nodes, medium, shapes, m);
    reflect.emplace_back(repeated.reflect + once.reflect);
    transmit.emplace_back(repeated.transmit + once.transmit);
    transmit.back().diagonal() += direct_transmissions(nodes.mu, medium);
  }
}

MediumOnTargets::MediumOnTargets(const Solution& media, std::size_t scatterer, const Directions& directions,
                                 int orders) {
  const TruncatedMedium& medium = media.scatterers()[scatterer].medium;
  const LayerShapes shapes(directions, medium);
  const Eigen::Index live = directions.live;
  const Eigen::Index targets = directions.targets;
  for (int m = 0; m < orders; ++m) {
    const LayerKernels repeated = repeated_on(media, scatterer, directions, shapes, m);
    const LayerKernels once = single_on(directions, medium, shapes, m);
    reflect.emplace_back((repeated.reflect + once.reflect).topRightCorner(live, targets));
    transmit.emplace_back((repeated.transmit + once.transmit).topRightCorner(live, targets));
    reflect_between.emplace_back(repeated.reflect.bottomRightCorner(targets, targets));
    transmit_between.emplace_back(repeated.transmit.bottomRightCorner(targets, targets));
  }
}

}  // namespace lamina
