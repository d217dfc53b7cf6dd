// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering function of a rough boundary or of a rough metal.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "matter/stack.hpp"
#include "operators/scattering_function.hpp"
#include "rough/lobe_operator.hpp"
#include "rough/resolved_lobe.hpp"

namespace lamina {

/// The two faces of a boundary, where light arrives or leaves.
enum class Face { kTop, kBottom };

/// A rough boundary between two dielectrics, or the facets of a base, as operators in all azimuth orders.
///
/// Single scattering by facets loses energy to shadowing. Compensation lets refracted light pass, see Facets::passed,
/// and returns the other energy in proportion to the losses of the directions on both sides (Kulla and Conty, SIGGRAPH
/// 2017 course), so a dielectric boundary absorbs nothing.
/// Without compensation the energy stays lost.
class RoughSurface {
 public:
  /// `fineness` multiplies the density of facet normals. 1 is enough beside smoothly scattering media; lobes that meet
  /// other lobes or mirrors need more.
  RoughSurface(const Interface& interface, const DirectionSet& set, double ior_above, int orders, ThreadPool& pool,
               double fineness = 1.0);
  /// `tolerance`: the relative pointwise error of the solve.
  RoughSurface(const Base& base, const DirectionSet& set, double ior_above, int orders, ThreadPool& pool,
               double fineness = 1.0, double tolerance = 1e-3);
  RoughSurface(const RoughSurface&) = delete;  // its resolved lobe calls values()
  RoughSurface& operator=(const RoughSurface&) = delete;

  /// The boundary on directions with targets, one azimuth order at a time. Refers to the boundary and the directions.
  class Operators {
   public:
    /// Lobes between two targets are left out, see LobeOperator; the compensation, which is smooth, is included.
    ScatteringFunction order(int m) const;
    /// One order of the lobes alone, from targets on one face to the live nodes of the medium at another:
    /// [live node, target]. Without view_weight().
    const Eigen::MatrixXd& from_targets(Face from, Face to, int m) const;
    int orders() const { return static_cast<int>(surface_->nodes_.size()); }

   private:
    friend class RoughSurface;
    Operators(const RoughSurface& surface, const Directions& above, const Directions& below)
        : surface_(&surface), above_(&above), below_(&below) {}

    ScatteringFunction lobes(int m) const;
    void compensate(ThreadPool& pool);

    const RoughSurface* surface_;
    const Directions* above_;
    const Directions* below_;
    std::shared_ptr<const LobeColumns> downward_;
    std::shared_ptr<const LobeColumns> upward_;
    // The compensation from any direction to any other is the product of the losses there times this share.
    double share_ = 0.0;
    Eigen::VectorXd lost_above_;
    Eigen::VectorXd lost_below_;
  };
  Operators on(const Directions& above, const Directions& below, ThreadPool& pool) const;

  /// The lobes on other nodes and in other azimuth orders: for light from above and, unless the surface is a base, for
  /// light from below.
  std::vector<LobeOperator> lobes_on(const DirectionSet& set, int orders) const;
  /// The rays of the lobes, for integrands that are polynomials of `degree`; in the order of lobes_on.
  std::vector<FacetRays> rays_on(const DirectionSet& set, int degree) const;

  /// True for a base whose lobe is a sum over rays, but would be resolved by more nodes. Such sums leave noise in high
  /// azimuth orders.
  bool is_noisy() const { return is_noisy_; }

  /// The boundary as light that arrives at this face meets it.
  const FacetOptics& optics(Face from) const { return from == Face::kTop ? above_ : below_; }

  /// The lobes in closed form, for light that arrives at the face `from` and leaves at the face `to`. `mu_from` and
  /// `mu_to` are cosines in the media there, `cosines` those of the azimuths dphi. Radiance in 1/sr for unit
  /// irradiance, divided by the square of the index on the side `to`.
  Eigen::ArrayXd value(Face from, Face to, double mu_from, double mu_to, const Eigen::ArrayXd& cosines) const;
  /// The factor of light that leaves at cosine `mu`: 1, except for a base that is not reciprocal.
  double view_weight(double mu) const { return base_ ? base_->view_weight(mu) : 1.0; }
  /// The lobes without view_weight(), which are symmetric, towards many directions, each at its own azimuths:
  /// [direction, azimuth].
  Eigen::ArrayXXd values(Face from, Face to, double mu_from, const FacetPairs& pairs) const;

 private:
  /// One azimuth order on live nodes; a base has only reflect_above.
  struct Nodes {
    Eigen::MatrixXd reflect_above;
    Eigen::MatrixXd transmit;
    Eigen::MatrixXd reflect_below;
  };

  /// True if light that arrives at one face can leave at the other.
  bool exists(Face from, Face to) const { return !base_ || (from == Face::kTop && to == Face::kTop); }
  bool is_reciprocal() const { return !base_ || base_->is_reciprocal(); }
  /// The lobe between two faces for which exists() is true; `towards`: as the functions of microfacet.hpp take them.
  template <typename... Towards>
  auto lobe(Face from, Face to, double mu_from, const Towards&... towards) const;

  Facets facets_;
  std::optional<Base> base_;
  std::function<double(double)> reflectance_;  // of a facet of the base, by the cosine between ray and facet
  FacetOptics above_;
  FacetOptics below_;
  std::optional<LobeOperator> from_above_;
  std::optional<LobeOperator> from_below_;  // empty for a base
  std::optional<ResolvedLobe> resolved_;    // of a base whose lobe the nodes resolve
  std::vector<Nodes> nodes_;                // by order
  std::optional<LobeOperator> perfect_;     // of a conductor with compensation: its facets, reflecting everything
  Eigen::MatrixXd perfect_nodes_;
  bool is_noisy_ = false;
  double mean_fresnel_ = 1.0;
  bool compensate_ = true;
};

}  // namespace lamina
