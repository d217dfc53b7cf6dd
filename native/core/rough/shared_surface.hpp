// SPDX-License-Identifier: GPL-3.0-or-later
// A cache of rough boundaries shared by several solutions.
#pragma once
#include <memory>

#include "rough/rough_surface.hpp"

namespace lamina {

/// The rough boundary with these parameters, see RoughSurface. If another solution holds an equal boundary, that
/// boundary is returned. This saves most of the time of a solve, because the channels of a stack often differ in their
/// media only. Thread-safe.
std::shared_ptr<const RoughSurface> shared_surface(const Interface& interface, const DirectionSet& set,
                                                   double ior_above, int orders, ThreadPool& pool, double fineness);
std::shared_ptr<const RoughSurface> shared_surface(const Base& base, const DirectionSet& set, double ior_above,
                                                   int orders, ThreadPool& pool, double fineness, double tolerance);

}  // namespace lamina
