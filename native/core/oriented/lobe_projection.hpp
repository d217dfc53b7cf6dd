// SPDX-License-Identifier: GPL-3.0-or-later
// Sums bundles of rays onto the directions of a solve with coupled azimuths.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "operators/directions.hpp"
#include "oriented/azimuth_blocks.hpp"
#include "oriented/facet_bundle.hpp"

namespace lamina {

/// n sin(theta) of the live nodes of a medium. Odd functions of the azimuth are in proportion to it near the normal, and
/// only then polynomials in the cosine.
Eigen::VectorXd common_sines(const Directions& directions);

/// Distributes rays in one medium over its nodes, by the polynomials through them, and over functions of the azimuth.
/// Energy and all resolved moments of the rays are kept.
class LobeProjection {
 public:
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
  Eigen::VectorXd sines_;
};

}  // namespace lamina
