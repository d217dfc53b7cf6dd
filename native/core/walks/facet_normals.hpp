// SPDX-License-Identifier: GPL-3.0-or-later
// Density and sampling of facet normals for single rays.
#pragma once
#include "matter/microfacet.hpp"
#include "numeric/rng.hpp"
#include "walks/sphere.hpp"

namespace lamina {

/// A facet normal among those that a ray sees that leaves the surface along `view` (view.z > 0), in proportion to
/// the area it sees: density D G1 (view . normal)+ / view.z, from two uniform numbers. GGX: Dupuy and Benyoub (2023);
/// Beckmann: Heitz and d'Eon (2014), the slope in the plane of the ray found by iteration to rounding.
Ray visible_normal(const Facets& facets, const Ray& view, double u, double v);

}  // namespace lamina
