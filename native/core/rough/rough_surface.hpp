// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering function of a rough boundary or of a rough metal.
#pragma once
#include <complex>
#include <optional>
#include <vector>

#include "matter/stack.hpp"
#include "operators/scattering_function.hpp"
#include "rough/lobe_operator.hpp"

namespace lamina {

/// The two sides of a boundary: light meets it, or leaves it, above or below.
enum class Face { kTop, kBottom };

/// A rough boundary, between two dielectrics or of a conductor, as operators of all azimuth orders.
///
/// What single-scattering facets lose to shadowing is given back in proportion to the loss of the
/// directions on both sides (Kulla and Conty, SIGGRAPH 2017 course), so that a dielectric boundary absorbs
/// nothing; without compensation it stays lost.
class RoughSurface {
 public:
  /// `fineness` multiplies the density of facets: 1 will do beside what scatters smoothly, lobes that meet lobes
  /// or mirrors need more.
  RoughSurface(const Interface& interface, const DirectionSet& set, double ior_above, int orders, ThreadPool& pool,
               double fineness = 1.0);
  RoughSurface(const Base& conductor, const DirectionSet& set, double ior_above, int orders, ThreadPool& pool,
               double fineness = 1.0);

  /// A rough boundary on directions with targets.
  struct Operators {
    std::vector<ScatteringFunction> orders;
    ScatteringFunction lobes;  ///< order 0 without what is given back
  };
  /// Lobes between two targets are left out, see LobeOperator; what is given back is smooth and there.
  Operators on(const Directions& above, const Directions& below, ThreadPool& pool) const;

  /// The lobes in closed form, for light that falls on one face and leaves by one, with cosines in the media there, at
  /// azimuths dphi of these cosines: radiance divided by the square of the index there, for unit irradiance, 1/sr.
  /// The same in both senses.
  Eigen::ArrayXd value(Face from, Face to, double mu_from, double mu_to, const Eigen::ArrayXd& cosines) const;
  /// The same towards many directions, each at azimuths of its own: [direction, azimuth].
  Eigen::ArrayXXd values(Face from, Face to, double mu_from, const FacetPairs& pairs) const;

 private:
  /// One azimuth order on live nodes; of a conductor the first alone.
  struct Nodes {
    Eigen::MatrixXd reflect_above;
    Eigen::MatrixXd transmit;
    Eigen::MatrixXd reflect_below;
  };

  /// Whether light that comes from one face may leave by the other.
  bool exists(Face from, Face to) const { return !metal_ || (from == Face::kTop && to == Face::kTop); }
  /// A lobe that exists, towards one direction or many, as the functions of microfacet.hpp take them.
  template <typename... Towards>
  auto lobe(Face from, Face to, double mu_from, const Towards&... towards) const;

  Facets facets_;
  std::optional<std::complex<double>> metal_;  // index of a conductor, relative to that above
  std::optional<LobeOperator> from_above_;
  std::optional<LobeOperator> from_below_;  // empty for a conductor
  std::vector<Nodes> nodes_;                // by order
  std::optional<LobeOperator> perfect_;     // of a conductor to be compensated: facets that reflect everything
  Eigen::MatrixXd perfect_nodes_;
  double mean_fresnel_ = 1.0;
  double ior_above_;
  double ior_below_;
  bool compensate_ = true;
};

}  // namespace lamina
