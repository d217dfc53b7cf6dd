// SPDX-License-Identifier: GPL-3.0-or-later
// The surface below the last layer of a stack.
#pragma once
#include <complex>
#include <functional>
#include <memory>

#include "matter/measured_reflection.hpp"
#include "matter/microfacet.hpp"
#include "matter/principled.hpp"

namespace lamina {

/// The surface below the last layer. Solver and walks do not ask for the kind, but for the properties below: a new kind
/// is described here.
struct Base {
  enum class Kind { kNone, kLambert, kConductor, kPrincipled, kMeasured, kRetroreflector };
  Kind kind = Kind::kNone;                        ///< kNone: the stack is a thin sheet, and light leaves at the bottom
  double reflectance = 0.0;                       ///< of a Lambert surface or a retroreflector, [0, 1]
  std::complex<double> ior = {};                  ///< of a conductor, n + ik, absolute
  Facets facets{.alpha = 0.0};                    ///< of a conductor, a Principled material or a retroreflector
  std::shared_ptr<const PrincipledLaw> law = {};  ///< of a Principled material
  std::shared_ptr<const Film> film = {};          ///< on a conductor; null without films
  /// Of a measured material, whose `facets` are as wide as its narrowest peak and only place rays.
  std::shared_ptr<const MeasuredReflection> measured = {};

  /// True if the base scatters light equally into all azimuths, without facets.
  bool is_diffuse() const { return law ? law->has_diffuse() : kind == Kind::kLambert && reflectance > 0.0; }
  /// True if the base reflects light into lobes: by facets, or as it was measured.
  bool is_rough() const { return has_facets() && facets.alpha > 0.0; }
  /// True if the base reflects light as a mirror, see mirror_reflectance(), and not by facets.
  bool is_mirror() const { return has_mirror() && !is_rough(); }
  /// True if the base reflects some light as a mirror.
  bool has_mirror() const { return (has_facets() && facets.alpha == 0.0) || (law && law->has_coat()); }
  bool is_glossy() const { return is_rough() || is_mirror(); }
  /// True for nothing and for a Lambert surface, which the methods for media alone include.
  bool is_none_or_lambert() const { return kind == Kind::kNone || kind == Kind::kLambert; }
  /// True if light that lobes lose to shadowing is returned by an operator of its own.
  bool compensates() const { return facets.compensate && !law && !measured; }
  /// True if an exchange of view and light changes nothing.
  bool is_reciprocal() const { return !law; }
  bool scatters() const { return is_diffuse() || is_rough(); }

  /// The reflectance of a mirror, in a medium of index `ior_above`, for unpolarised light at cosine `mu` there.
  double mirror_reflectance(double mu, double ior_above) const {
    if (is_rough() || !has_facets()) {
      return law ? law->coat(mu) : 0.0;
    }
    return law ? law->coat(mu) + view_weight(mu) * law->reflectance(mu) : optics(ior_above).reflectance(mu);
  }
  /// The reflectance of a facet by the cosine between ray and facet, in a medium of index `ior_above`.
  std::function<double(double)> facet_reflectance(double ior_above) const {
    if (law) {
      return [own = law](double cosine) { return own->reflectance(cosine); };
    }
    return [own = optics(ior_above)](double cosine) { return own.reflectance(cosine); };
  }
  /// A conductor or a retroreflector as light in a medium of index `ior_above` meets it.
  FacetOptics optics(double ior_above) const {
    if (kind == Kind::kRetroreflector) {
      return {.here = ior_above, .beyond = ior_above, .constant = reflectance};
    }
    return {ior_above, ior_above, ior / ior_above, film};
  }
  /// The factor of the light that facets reflect towards a viewer at cosine `mu`; 1 for a reciprocal base.
  double view_weight(double mu) const { return law ? law->lobe_weight(mu) : 1.0; }
  /// The reflectance of the diffuse part towards a viewer at cosine `mu`.
  double diffuse_reflectance(double mu) const { return law ? law->diffuse(mu) : reflectance; }

 private:
  bool has_facets() const {
    return kind == Kind::kConductor || kind == Kind::kRetroreflector || measured || (law && law->has_lobe());
  }
};

}  // namespace lamina
