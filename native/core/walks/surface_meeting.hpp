// SPDX-License-Identifier: GPL-3.0-or-later
// What happens to light that meets a boundary or the base.
#pragma once
#include "walks/walk_elements.hpp"

namespace lamina {

/// Light meets a smooth boundary or a polished metal: its ray turns, its weight falls by what a metal absorbs. False
/// when it is lost.
bool meet_polished(const WalkElements& stack, std::size_t element, Ray& ray, double& weight, Rng& rng);

/// Light is scattered by a rough boundary or a Lambert surface. False when it is lost.
bool scatter_at_surface(const WalkElements::Element& surface, Ray& ray, double& weight, Rng& rng);

}  // namespace lamina
