// SPDX-License-Identifier: GPL-3.0-or-later
// Coarse solutions of the part of a slab below each height, for guiding tables.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "matter/graded_medium.hpp"
#include "operators/directions.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {

/// Coarse solutions of the part of a slab below each of several heights, by azimuth order: what guides a walk.
/// A homogeneous slab's follow from its modes; a graded one is built up from the bottom, by adding layers.
class ReflectionByHeight {
 public:
  /// Heights ascend from above 0 to the slab's thickness. Directions are `nodes` of Gauss and Legendre, followed
  /// by the targets.
  ReflectionByHeight(const GradedMedium& medium, std::vector<double> heights, int nodes,
                     const Eigen::VectorXd& targets);

  /// Azimuth moments of Chandrasekhar's S, S = sum of (2 - [m = 0]) S_m cos(m dphi), at each height.
  std::vector<Eigen::MatrixXd> order(int m) const;

  int orders() const { return static_cast<int>(2 * directions_.nodes); }
  const Directions& directions() const { return directions_; }
  const std::vector<double>& heights() const { return heights_; }

  /// The medium around a height, as the nodes see it, of thickness tau.
  TruncatedMedium medium(double height, double tau) const;

 private:
  ScatteringFunction layer(int m, double height, double tau) const;

  GradedMedium medium_;
  std::vector<double> heights_;
  Directions directions_;
};

}  // namespace lamina
