// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "next_event.hpp"
#include "walk.hpp"
#include "walk_stack.hpp"

namespace lamina {

/// Photon walk of the equation of transfer with next-event estimation: any stack, both ways through it.
/// Absorption by weights, with Russian roulette; facets by visible normals. Throws std::invalid_argument.
std::unique_ptr<Walk> make_transfer_walk(const Stack& stack, const WalkTarget& target,
                                         NextEvent next_event = NextEvent::kFitting);

}  // namespace lamina
