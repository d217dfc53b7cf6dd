// SPDX-License-Identifier: GPL-3.0-or-later
// Rough boundaries that several solutions share.
#pragma once
#include <memory>

#include "rough/rough_surface.hpp"

namespace lamina {

/// The rough boundary of these parameters, see RoughSurface. A boundary that another solution already holds is returned
/// instead of a new one: the channels of a stack often differ in their media only, and the lobes take most of the time
/// of a solve. Thread-safe.
std::shared_ptr<const RoughSurface> shared_surface(const Interface& interface, const DirectionSet& set,
                                                   double ior_above, int orders, ThreadPool& pool, double fineness);
std::shared_ptr<const RoughSurface> shared_surface(const Base& conductor, const DirectionSet& set, double ior_above,
                                                   int orders, ThreadPool& pool, double fineness);

}  // namespace lamina
