// SPDX-License-Identifier: GPL-3.0-or-later
// What a boundary separates, and the Fresnel factor of its facets.
#pragma once
#include <complex>
#include <memory>
#include <optional>

#include "matter/film.hpp"
#include "matter/fresnel.hpp"

namespace lamina {

/// Fresnel reflectance of a smooth conductor of relative index `ratio`, and its mean for uniform diffuse light.
double conductor_fresnel(double mu, std::complex<double> ratio);
double mean_conductor_fresnel(std::complex<double> ratio);

/// A boundary as light on one side of it meets it: two media, or a medium and a metal, with or without thin films, or
/// an opaque surface that reflects the same at all angles.
struct FacetOptics {
  double here = 1.0;                               ///< index where the light is
  double beyond = 1.0;                             ///< index beyond; with a metal that where the light is
  std::optional<std::complex<double>> metal = {};  ///< relative to `here`
  std::shared_ptr<const Film> film = {};
  Film::Side side = Film::Side::kAbove;  ///< of the films, where the light is
  std::optional<double> constant = {};   ///< the reflectance at all angles

  double ratio() const { return beyond / here; }
  bool is_opaque() const { return metal || constant; }

  /// The reflectance by the cosine between ray and facet.
  double reflectance(double cosine) const {
    if (film) {
      return film->reflectance(cosine, side);
    }
    if (constant) {
      return *constant;
    }
    return metal ? conductor_fresnel(cosine, *metal) : fresnel(cosine, ratio());
  }
  /// The share that passes a facet, which is the rest unless a film absorbs.
  double transmittance(double cosine) const {
    if (is_opaque()) {
      return 0.0;
    }
    return film ? film->transmittance(cosine, side) : 1.0 - reflectance(cosine);
  }
  /// The reflectance of an opaque boundary for uniform diffuse light.
  double mean_reflectance() const {
    return film ? film->mean_reflectance() : constant ? *constant : mean_conductor_fresnel(*metal);
  }

  /// The same boundary from its other side.
  FacetOptics turned() const {
    const Film::Side other = side == Film::Side::kAbove ? Film::Side::kBelow : Film::Side::kAbove;
    return {beyond, here, metal, film, other, constant};
  }
};

}  // namespace lamina
