// SPDX-License-Identifier: GPL-3.0-or-later
// The surface below the last layer of a stack.
#pragma once
#include <complex>

#include "matter/microfacet.hpp"

namespace lamina {

/// The surface below the last layer. Solver and walks do not ask for the kind, but for the properties below: a new kind
/// is described here.
struct Base {
  enum class Kind { kNone, kLambert, kConductor };
  Kind kind = Kind::kNone;        ///< kNone: the stack is a thin sheet, and light leaves at the bottom
  double reflectance = 0.0;       ///< of a Lambert surface, [0, 1]
  std::complex<double> ior = {};  ///< of a conductor, n + ik, absolute
  Facets facets{.alpha = 0.0};    ///< of a conductor
  bool compensate = true;

  /// True if the base scatters light equally into all azimuths, without facets.
  bool is_diffuse() const { return kind == Kind::kLambert && reflectance > 0.0; }
  /// True if the base reflects light by facets, into lobes.
  bool is_rough() const { return kind == Kind::kConductor && facets.alpha > 0.0; }
  /// True if the base reflects light as a mirror, see mirror_reflectance().
  bool is_mirror() const { return kind == Kind::kConductor && !is_rough(); }
  bool is_glossy() const { return is_rough() || is_mirror(); }
  /// True for nothing and for a Lambert surface, which the methods for media alone include.
  bool is_none_or_lambert() const { return kind == Kind::kNone || kind == Kind::kLambert; }
  bool scatters() const { return is_diffuse() || is_rough(); }

  /// The reflectance of a mirror, in a medium of index `ior_above`, for unpolarised light at cosine `mu` there.
  double mirror_reflectance(double mu, double ior_above) const { return conductor_fresnel(mu, ior / ior_above); }
};

}  // namespace lamina
