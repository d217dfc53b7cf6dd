// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering of a solved medium in all azimuth orders of a solve with coupled azimuths.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "oriented/block_operator.hpp"
#include "solve/solution.hpp"

namespace lamina {

/// A medium on the live nodes, by order; transmission includes unscattered light.
struct MediumOnNodes {
  OrderMatrices reflect;
  OrderMatrices transmit;

  MediumOnNodes(const Solution& media, std::size_t scatterer, const Directions& nodes, int orders);
};

/// A medium between targets and nodes, by order.
struct MediumOnTargets {
  OrderMatrices reflect;  ///< [live node, target], all scattering
  OrderMatrices transmit;
  OrderMatrices reflect_between;  ///< [target, target], multiple scattering only
  OrderMatrices transmit_between;

  MediumOnTargets(const Solution& media, std::size_t scatterer, const Directions& directions, int orders);
};

}  // namespace lamina
