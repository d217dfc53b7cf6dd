// SPDX-License-Identifier: GPL-3.0-or-later
// Sampling of visible facet normals.
#pragma once
#include <vector>

#include "events/sphere.hpp"
#include "matter/microfacet.hpp"
#include "numeric/rng.hpp"

namespace lamina {

/// Samples a facet normal that is visible along `view` (view.z > 0), with density D G1 (view . normal)+ / view.z, from
/// two uniform numbers. GGX: Dupuy and Benyoub (2023). Beckmann: Heitz and d'Eon (2014), where the slope in the plane
/// of the ray is found by iteration to rounding.
Ray visible_normal(const Facets& facets, const Ray& view, double u, double v);

/// Two numbers for visible_normal, and their weight in a mean over all visible facets.
struct VisibleFacet {
  double u;
  double v;
  double weight;
};

/// A quadrature over the facets on one side of the plane of incidence, for functions that are symmetric about the
/// plane.
std::vector<VisibleFacet> visible_facets(Facets::Distribution distribution);
/// A coarser quadrature over the facets on both sides.
std::vector<VisibleFacet> all_visible_facets(Facets::Distribution distribution);

}  // namespace lamina
