// SPDX-License-Identifier: GPL-3.0-or-later
// Flakes with thin films: interference pigments.
#pragma once
#include "matter/film.hpp"
#include "numeric/chebyshev_panels.hpp"

namespace lamina {

/// What flakes with films reflect and pass, and the areas with which flakes of one spread do so along a ray. Platelets
/// pass light straight on.
class FilmedFlakes {
 public:
  /// `alpha`: see Flakes.
  FilmedFlakes(Film film, double alpha);

  /// What a flake reflects, and what it does not pass, of a ray of this cosine with its normal.
  double reflectance(double cosine) const { return film_.reflectance(cosine, Film::Side::kAbove); }
  double taken(double cosine) const {
    return film_.is_opaque() ? 1.0 : 1.0 - film_.transmittance(cosine, Film::Side::kAbove);
  }
  /// The integrals of D |m.w| over half the sphere of normals m, weighted with the reflectance and with what is taken,
  /// for a ray w of cosine `mu` with the layer's normal. Accurate to 1e-6, with flakes of spread .1 to 1e-5 at grazing.
  double reflecting_area(double mu) const { return areas_.at(0, mu); }
  double taking_area(double mu) const { return areas_.at(1, mu); }
  bool conserves() const { return film_.conserves(); }

 private:
  Film film_;
  ChebyshevPanels<2> areas_;
};

}  // namespace lamina
