// SPDX-License-Identifier: GPL-3.0-or-later
// Light that the facets of rough boundaries scatter twice, integrated over the rays of both lobes.
#pragma once
#include <Eigen/Core>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include "rough/facet_rays.hpp"
#include "solve/assembly.hpp"
#include "solve/evaluation.hpp"
#include "solve/mirror_sections.hpp"

namespace lamina {

/// Light scattered twice by facets, with only specular reflection and attenuation in between: from the lobe of one
/// rough boundary into the lobe of another, or of the same boundary by way of a mirror. The product of two narrow lobes
/// is as narrow as the lobes, and polynomials through the nodes would ring. Between targets the product is therefore
/// integrated over the rays of both lobes. Each ray is weighted by its lobe's share of the density of both lobes
/// (balance heuristic, Veach and Guibas 1995), so the integrand is smooth on the scale of the rays of either lobe.
class FacetMeetings {
 public:
  /// Keeps references into the assembly.
  explicit FacetMeetings(const Assembly& assembly);

  bool none() const { return meetings_.empty(); }

  /// Subtracts the interpolation of such light through the nodes from one azimuth order between targets.
  void take_from(ScatteringFunction& rest, int order) const;

  /// BRDF or BTDF in 1/sr between two targets, of light that enters on `side`. Thread-safe.
  Eigen::ArrayXd value(Side side, Path path, Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& dphi) const;

 private:
  /// A specular path from the face of a boundary where light leaves to the face of a boundary where light arrives.
  struct Meeting {
    std::size_t first;
    Face leaving;
    std::size_t second;
    Face arriving;
    std::size_t section;
    Eigen::ArrayXd Deltas::* between;
  };
  struct Boundary {
    std::size_t gap_above;  // the medium above it
    std::size_t gap_below;
    const RoughSurface* surface;
    std::vector<FacetRays> rays;  // from above; between dielectrics also from below
  };
  std::size_t gap(std::size_t boundary, Face face) const {
    return face == Face::kTop ? boundaries_[boundary].gap_above : boundaries_[boundary].gap_below;
  }
  Eigen::ArrayXd between_nodes(const Meeting& meeting) const;
  double cosine(std::size_t boundary, Face face, Eigen::Index target) const;
  /// Light does not enter or leave a conductor from below.
  bool exists(std::size_t boundary, Face face) const {
    return face == Face::kTop || boundaries_[boundary].rays.size() > 1;
  }
  /// The rays of a lobe on one side of a boundary.
  struct Lobe {
    Eigen::ArrayXd mu;       ///< cosines with the normal
    Eigen::ArrayXd azimuth;  ///< cosines of the azimuth, 1 forward
    Eigen::ArrayXd share;    ///< shares of the incident flux
    Eigen::ArrayXd density;  ///< density of the lobe at its rays, normalised to a flux of 1
    double whole = 0.0;      ///< the sum of the shares
  };
  using LobeKey = std::tuple<std::size_t, Face, Face, double>;
  /// Cached lobes by boundary, the face where light arrives, the face where light leaves, and incident cosine.
  struct Lobes {
    std::mutex lock;
    std::map<LobeKey, std::shared_ptr<const Lobe>> known;
    std::size_t rays = 0;
  };
  /// A lobe from the cache, computed on first use. The cache is cleared when it exceeds kMostRays.
  std::shared_ptr<const Lobe> lobe(std::size_t boundary, Face from, Face to, double mu) const;
  Lobe made_lobe(std::size_t boundary, Face from, Face to, double mu) const;
  Eigen::VectorXd view_weights(std::size_t boundary, Face face, bool at_targets) const;
  Eigen::MatrixXd to_nodes(std::size_t boundary, Face from, Face to, int order) const;
  void add_rays(Eigen::ArrayXd& sum, const Meeting& meeting, bool backwards, const Lobe& own, const Lobe& other,
                Face face, double mu, const Eigen::ArrayXd& dphi) const;

  const Assembly& assembly_;
  MirrorSections sections_;
  std::vector<Boundary> boundaries_;
  std::vector<Meeting> meetings_;
  std::unique_ptr<Lobes> lobes_ = std::make_unique<Lobes>();
};

}  // namespace lamina
