// SPDX-License-Identifier: GPL-3.0-or-later
// The directional albedo of GGX facets, as Cycles reads it from its tables.
#pragma once
#include <functional>
#include <vector>

namespace lamina {

/// A table over uniform cosines from 0 to 1, linear in between.
struct CosineRows {
  std::vector<double> values;
  double at(double mu) const;
};

/// The albedo of GGX facets of one roughness that reflect everything: by cosine, and for uniform diffuse light. Cycles
/// interpolates linearly between 32 roughnesses and 32 cosines; so does this table.
struct FacetAlbedo {
  CosineRows directional;
  double mean = 1.0;
};
FacetAlbedo facet_albedo(double roughness);

/// The mean over visible facets of (F - F0) / (1 - F0), by cosine, where F is Fresnel's reflectance at relative index
/// `eta`. Cycles interpolates linearly between 16 roughnesses, 16 cosines and 16 indices.
CosineRows fresnel_rise(double roughness, double eta);

/// The mean over visible facets of (1 - cosine)^5, Schlick's rise of a metal's reflectance. By cosine, as above.
CosineRows schlick_rise(double roughness);

/// Light that GGX facets reflect once, relative to a smooth surface of the same `reflectance`, which is given by the
/// cosine between ray and facet: a table over the square root of the cosine, for exactly this roughness.
CosineRows facet_share(double roughness, const std::function<double(double)>& reflectance);

}  // namespace lamina
