// SPDX-License-Identifier: GPL-3.0-or-later
// A cache of anisotropic boundaries shared by several solutions.
#pragma once
#include <memory>

#include "oriented/oriented_surface.hpp"

namespace lamina {

/// The boundary with these parameters, see OrientedSurface; that of another solution if one holds an equal boundary.
/// The channels of a stack often differ in their media only. Thread-safe.
std::shared_ptr<const OrientedSurface> shared_oriented_surface(const Facets& facets, const FacetOptics& optics,
                                                               const DirectionSet& set, const AzimuthBlocks& azimuths,
                                                               int fineness, ThreadPool& pool);

}  // namespace lamina
