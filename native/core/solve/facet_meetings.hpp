// SPDX-License-Identifier: GPL-3.0-or-later
// Light that rough boundaries scatter twice, integrated along the rays of both lobes.
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

/// Light that facets scatter twice, with nothing but mirrors and attenuation between: a lobe seen in a lobe, of two
/// rough boundaries or of one that a mirror shows to itself. The product of two narrow lobes is as narrow as they are,
/// so polynomials through the nodes would ring. Between targets it is therefore integrated over the rays of both lobes:
/// each ray counts with its lobe's share of the density of both (balance heuristic; Veach and Guibas 1995), so that
/// the integrand is smooth on the scale of the rays of either.
class FacetMeetings {
 public:
  /// Keeps references into the assembly.
  explicit FacetMeetings(const Assembly& assembly);

  bool none() const { return meetings_.empty(); }

  /// Takes out of an azimuth order between targets what the nodes' polynomials say of such light.
  void take_from(ScatteringFunction& rest, int order) const;

  /// BRDF or BTDF in 1/sr between two targets, of light that enters on `side`. For any number of threads.
  Eigen::ArrayXd value(Side side, Path path, Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& dphi) const;

 private:
  /// From a face of one boundary, as light leaves, to a face of one, as light arrives.
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
  /// Nothing leaves a conductor below.
  bool exists(std::size_t boundary, Face face) const {
    return face == Face::kTop || boundaries_[boundary].rays.size() > 1;
  }
  /// A lobe's rays into one side.
  struct Lobe {
    Eigen::ArrayXd mu;       ///< cosines there
    Eigen::ArrayXd azimuth;  ///< cosines of the azimuth, 1 forward
    Eigen::ArrayXd share;    ///< of the incident flux
    Eigen::ArrayXd density;  ///< of the lobe along its own rays, of whole flux 1
    double whole = 0.0;      ///< the sum of the shares
  };
  using LobeKey = std::tuple<std::size_t, Face, Face, double>;
  /// Lobes by boundary, face that light comes from, face that it leaves by, and cosine.
  struct Lobes {
    std::mutex lock;
    std::map<LobeKey, std::shared_ptr<const Lobe>> known;
    std::size_t rays = 0;
  };
  /// Made once and kept for later calls, as long as all that are kept take no more than some megabytes.
  std::shared_ptr<const Lobe> lobe(std::size_t boundary, Face from, Face to, double mu) const;
  Lobe made_lobe(std::size_t boundary, Face from, Face to, double mu) const;
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
