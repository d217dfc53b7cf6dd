// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "walk_stack.hpp"

namespace lamina {

/// Light meets a smooth boundary or a polished metal: its ray turns, its weight falls by what a metal absorbs. False
/// when it is lost.
bool meet_polished(const WalkStack& stack, std::size_t element, Ray& ray, double& weight, Rng& rng);

/// Light is scattered by a rough boundary or a Lambert surface. False when it is lost.
bool scatter_at_surface(const WalkStack::Element& surface, Ray& ray, double& weight, Rng& rng);

}  // namespace lamina
