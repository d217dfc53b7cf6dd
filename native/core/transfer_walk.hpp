// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "walk.hpp"
#include "walk_stack.hpp"

namespace lamina {

/// How the transfer walk adds what leaves without another event.
enum class NextEvent {
  kAlongFlight,  ///< at every point of each flight, integrated in closed form: collisions on it need not happen
  kAtCollision,  ///< at the end of each flight that collides: the textbook's way
};

/// Photon walk of the equation of transfer with next-event estimation: any stack, both ways through it.
/// Absorption by weights, with Russian roulette; facets by visible normals. Throws std::invalid_argument.
std::unique_ptr<Walk> make_transfer_walk(const Stack& stack, const WalkTarget& target,
                                         NextEvent next_event = NextEvent::kAlongFlight);

}  // namespace lamina
