// SPDX-License-Identifier: GPL-3.0-or-later
// The transfer walk in one homogeneous medium without boundaries: the fast path.
#pragma once
#include <memory>

#include "matter/medium.hpp"
#include "walks/next_event.hpp"
#include "walks/walk.hpp"
#include "walks/walk_elements.hpp"

namespace lamina {

/// The transfer walk in one homogeneous medium without boundaries, compiled for each kind of phase function.
std::unique_ptr<Walk> make_slab_walk(const Medium& medium, const WalkTarget& target, NextEvent next_event);

}  // namespace lamina
