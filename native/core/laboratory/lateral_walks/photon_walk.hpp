// SPDX-License-Identifier: GPL-3.0-or-later
// The classical photon walk for a pencil beam.
#pragma once
#include <memory>
#include <vector>

#include "lateral_walks/depth_scale.hpp"
#include "lateral_walks/lateral_walk.hpp"
#include "matter/stack.hpp"

namespace lamina {

/// Photons of the equation of transfer through any stack, for a pencil beam of cosine `mu_i` in air that enters above.
/// The first scattering of the beam is forced. Exits are analog, without next-event estimation. Absorption is by
/// weights with Russian roulette; facets are sampled by visible normals. `scales`: lengths in millimetres, one per
/// layer. Throws std::invalid_argument.
std::unique_ptr<LateralWalk> make_photon_walk(const Stack& stack, const std::vector<DepthScale>& scales, double mu_i);

}  // namespace lamina
