// SPDX-License-Identifier: GPL-3.0-or-later
// The photon walk of the equation of transfer in any stack.
#pragma once
#include <memory>

#include "walks/next_event.hpp"
#include "walks/walk.hpp"
#include "walks/walk_elements.hpp"

namespace lamina {

/// Photon walk of the equation of transfer with next-event estimation, for any stack, reflection and transmission.
/// Absorption by weights with Russian roulette; facets by visible normals. Throws std::invalid_argument.
std::unique_ptr<Walk> make_transfer_walk(const Stack& stack, const WalkTarget& target,
                                         NextEvent next_event = NextEvent::kFitting);

}  // namespace lamina
