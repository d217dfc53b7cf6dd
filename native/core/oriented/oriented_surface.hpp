// SPDX-License-Identifier: GPL-3.0-or-later
// A rough boundary, isotropic or anisotropic, as operators that couple azimuths.
#pragma once
#include <Eigen/Core>
#include <numbers>
#include <vector>

#include "numeric/thread_pool.hpp"
#include "operators/directions.hpp"
#include "oriented/azimuth_blocks.hpp"
#include "oriented/facet_bundle.hpp"
#include "oriented/lobe_projection.hpp"
#include "rough/rough_surface.hpp"

namespace lamina {

/// A rough boundary between two dielectrics, or the facets of a metal, on the nodes of a solve and the functions of the
/// azimuth. Energy that single scattering by facets loses is given back as by RoughSurface, in proportion to the losses
/// of both directions, which here depend on the azimuth. Vectors run over functions, and over the live nodes of each.
class OrientedSurface {
 public:
  /// `facets` with the angle from the x axis of the solve. `fineness`: see FacetBundle. A metal is an opaque base.
  OrientedSurface(const Facets& facets, const FacetOptics& optics, const DirectionSet& set,
                  const AzimuthBlocks& azimuths, int fineness, ThreadPool& pool);
  OrientedSurface(const OrientedSurface&) = delete;  // its projections refer to its own directions
  OrientedSurface& operator=(const OrientedSurface&) = delete;

  /// One block of azimuth functions; a metal has only reflect_above. Light from below is transmitted by the transpose.
  struct Block {
    Eigen::MatrixXd reflect_above;
    Eigen::MatrixXd transmit;
    Eigen::MatrixXd reflect_below;
  };
  const Block& block(std::size_t index) const { return blocks_[index]; }
  /// Frees the memory of the blocks.
  void forget_blocks() { blocks_.clear(); }
  bool is_opaque() const { return optics_.metal.has_value(); }

  /// A single direction of light that arrives at one face: how it scatters into the nodes above and below, [live node,
  /// function], and the share that the facets lose.
  struct Column {
    Eigen::MatrixXd above;
    Eigen::MatrixXd below;
    double lost = 0.0;
  };
  Column column(Face from, const Heading& in) const;
  /// Single scattering and compensation between two directions: radiance in 1/sr divided by the square of the index
  /// there, for unit irradiance. The losses are those of their columns.
  double value(Face from, Face to, const Heading& in, const Heading& out, double lost_in, double lost_out) const {
    return once(from, to, in, out) + returned(lost_in, lost_out);
  }
  /// Of `value`, the light that one facet scatters.
  double once(Face from, Face to, const Heading& in, const Heading& out) const;
  /// Of `value`, the compensation.
  double returned(double lost_in, double lost_out) const { return share_ * lost_in * lost_out / std::numbers::pi; }

 private:
  /// Light from one side in the frame of the tangent: sums over rays, by block, and what facets hide.
  struct Lobes {
    std::vector<Eigen::MatrixXd> reflected;
    std::vector<Eigen::MatrixXd> transmitted;
    Eigen::VectorXd lost;  ///< in the first block
  };
  Lobes lobes(Face from, ThreadPool& pool) const;
  void merge(const Lobes& above, const Lobes& below, const AzimuthBlocks& azimuths);
  void restore_flux(const Lobes& above, const Lobes& below);
  void compensate(const Lobes& above, const Lobes& below);
  void turn(const AzimuthBlocks& azimuths);

  const FacetOptics& optics_of(Face from) const { return from == Face::kTop ? optics_ : turned_optics_; }
  const Directions& nodes_of(Face face) const { return face == Face::kTop ? above_ : below_; }
  FacetEnds ends_of(Face from) const {
    return from == Face::kTop ? FacetEnds{set_.ends(above_.ior), set_.ends(below_.ior)}
                              : FacetEnds{set_.ends(below_.ior), set_.ends(above_.ior)};
  }
  Eigen::VectorXd common(Face face) const { return nodes_of(face).ior * nodes_of(face).scale; }

  Facets facets_;  ///< with the tangent along the x axis
  double angle_;
  FacetOptics optics_;
  FacetOptics turned_optics_;
  DirectionSet set_;
  AzimuthBlocks own_;  ///< in the frame of the tangent
  FacetBundle bundle_;
  Directions above_;
  Directions below_;
  LobeProjection to_above_;
  LobeProjection to_below_;
  std::vector<Block> blocks_;
  double share_ = 0.0;          ///< of the product of two losses in the compensation
  Eigen::MatrixXd lost_above_;  ///< [live node, function]
  Eigen::MatrixXd lost_below_;
};

}  // namespace lamina
