// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "medium.hpp"
#include "next_event.hpp"
#include "walk.hpp"
#include "walk_stack.hpp"

namespace lamina {

/// The transfer walk in one homogeneous medium without boundaries, in a loop of its own for each kind of phase
/// function.
std::unique_ptr<Walk> make_slab_walk(const Medium& medium, const WalkTarget& target, NextEvent next_event);

}  // namespace lamina
