// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that the Principled BSDF of Cycles 4.5 renders: facets over a diffuse surface, under a coat.
#pragma once
#include <vector>

#include "matter/facet_albedo.hpp"

namespace lamina {

/// The sockets of the Principled BSDF, one channel. `ior` and `coat_ior` are relative to the medium above.
struct PrincipledSockets {
  double color = 0.8;
  double metallic = 0.0;
  double roughness = 0.5;  ///< square root of the microfacet width
  double ior = 1.5;
  double specular = 0.5;
  double coat = 0.0;
  double coat_roughness = 0.03;
  double coat_ior = 1.5;
};

/// Multiscatter GGX facets of a dielectric under a weight, by Cycles' law.
struct DielectricLobe {
  /// `index`: relative index; `normal`: reflectance at normal incidence.
  DielectricLobe(double index, double normal, double roughness);

  /// The reflectance of a facet at the cosine between ray and facet: between F0 and 1 by Fresnel's equations.
  double reflectance(double cosine) const;
  /// The factor for light that facets scatter repeatedly, by the view cosine (Kulla and Conty 2017).
  double gain(double mu) const;
  /// The directional albedo that Cycles takes from the light below the lobe.
  double albedo(double mu) const;

  double eta;
  double f0;
  FacetAlbedo facets;
  CosineRows rise;
  double repeated;  ///< mean reflectance of repeatedly scattered light, relative to a single reflection
};

/// The law of the surface. The weights depend on the view only: the surface is not reciprocal.
///
/// value(view, light) = lobe_weight(view) * facets(view, light) + diffuse(view) / pi, plus the mirror image in the
/// coat. The facets of the metal and of the dielectric have one width and are one lobe. The coat is a mirror here
/// with the energy of its facets: its width is that of its closure in a lookup table.
class PrincipledLaw {
 public:
  explicit PrincipledLaw(const PrincipledSockets& sockets);

  /// The reflectance of a facet of the main lobe at the cosine between ray and facet.
  double reflectance(double cosine) const;
  double lobe_weight(double mu) const;
  /// The reflectance of the diffuse surface, by the view cosine.
  double diffuse(double mu) const;
  /// The share of light that the coat's facets reflect.
  double coat(double mu) const;

  /// All parameters, for caches.
  std::vector<double> key() const;

  bool has_diffuse() const { return sockets_.color > 0.0 && sockets_.metallic < 1.0; }
  bool has_lobe() const { return sockets_.metallic > 0.0 || lobe_.eta != 1.0; }
  bool has_coat() const { return sockets_.coat > 0.0 && coat_.eta != 1.0; }

 private:
  double below_coat(double mu) const;

  PrincipledSockets sockets_;
  DielectricLobe lobe_;
  DielectricLobe coat_;
  CosineRows coat_share_;  // see facet_share
  CosineRows metal_rise_;
  double metal_repeated_;
};

}  // namespace lamina
