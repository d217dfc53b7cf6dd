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

/// A boundary as light on one side of it meets it: two media, or a medium and a metal, with or without thin films.
struct FacetOptics {
  double here = 1.0;                               ///< index where the light is
  double beyond = 1.0;                             ///< index beyond; with a metal that where the light is
  std::optional<std::complex<double>> metal = {};  ///< relative to `here`
  std::shared_ptr<const Film> film = {};
  Film::Side side = Film::Side::kAbove;  ///< of the films, where the light is

  double ratio() const { return beyond / here; }
  bool is_opaque() const { return metal.has_value(); }

  /// The reflectance by the cosine between ray and facet.
  double reflectance(double cosine) const {
    if (film) {
      return film->reflectance(cosine, side);
    }
    return metal ? conductor_fresnel(cosine, *metal) : fresnel(cosine, ratio());
  }
  /// The share that passes a facet, which is the rest unless a film absorbs.
  double transmittance(double cosine) const {
    return film && !metal ? film->transmittance(cosine, side) : metal ? 0.0 : 1.0 - reflectance(cosine);
  }
  /// The reflectance of a metal for uniform diffuse light.
  double mean_reflectance() const { return film ? film->mean_reflectance() : mean_conductor_fresnel(*metal); }

  /// The same boundary from its other side.
  FacetOptics turned() const {
    return {beyond, here, metal, film, side == Film::Side::kAbove ? Film::Side::kBelow : Film::Side::kAbove};
  }
};

}  // namespace lamina
