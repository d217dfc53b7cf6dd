// SPDX-License-Identifier: GPL-3.0-or-later
// Sums bundles of rays onto the directions of a solve with coupled azimuths.
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "operators/directions.hpp"
#include "oriented/azimuth_blocks.hpp"
#include "oriented/facet_bundle.hpp"

namespace lamina {

/// How light of an azimuth order vanishes at the normal, by n sin(theta): a factor beside which the light is smooth in
/// the cosine. Rays that pass close to the normal then meet functions of the azimuth that are smooth there too.
class PoleFactor {
 public:
  static constexpr std::size_t kKinds = 4;
  /// Order 0, order 1, other even and other odd orders.
  static std::size_t kind_of(int order) { return static_cast<std::size_t>(order < 2 ? order : 2 + order % 2); }
  static Eigen::ArrayXd at(std::size_t kind, const Eigen::ArrayXd& common_sines);
  /// At the live nodes of a medium.
  static Eigen::VectorXd on(std::size_t kind, const Directions& directions);
};

/// Distributes rays in one medium over its nodes, by the polynomials through them, and over functions of the azimuth.
/// Energy and all resolved moments of the rays are kept.
class LobeProjection {
 public:
  /// Keeps references into the set.
  LobeProjection(const DirectionSet& set, double ior, int orders);

  /// The sums, [live node, function], in the scale of Directions.
  Eigen::MatrixXd sum(const RayList& rays) const;

 private:
  /// The rays whose cosines lie in one range of nodes.
  struct Part {
    const DirectionSet::Range* range;
    Eigen::Index first;
  };
  std::size_t part_of(double mu, double& own) const;

  std::vector<Part> parts_;
  double ior_;
  AzimuthBlocks azimuths_;
  Eigen::VectorXd inverse_common_;
  std::array<Eigen::VectorXd, PoleFactor::kKinds> inverse_factors_;
};

}  // namespace lamina
