// SPDX-License-Identifier: GPL-3.0-or-later
// Coarse solutions of the part of a slab below each height, for guiding tables.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "matter/graded_medium.hpp"
#include "operators/directions.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {

/// Number of quadrature nodes that resolve the phase function's peak well enough for a guide.
int guide_nodes(const GradedMedium& medium);

/// Coarse solutions of the part of a slab below each of several heights, by azimuth order, for guiding tables.
/// Those of a homogeneous slab follow from its modes; those of a graded slab are built from the bottom by adding
/// layers.
class ReflectionByHeight {
 public:
  /// Heights ascend from above 0 to the slab's thickness. Directions are `nodes` Gauss-Legendre nodes, followed by
  /// the targets.
  ReflectionByHeight(const GradedMedium& medium, std::vector<double> heights, int nodes,
                     const Eigen::VectorXd& targets);

  /// Azimuth moments of Chandrasekhar's S, S = sum of (2 - [m = 0]) S_m cos(m dphi), at each height.
  std::vector<Eigen::MatrixXd> order(int m) const;

  int orders() const { return static_cast<int>(2 * directions_.nodes); }
  const Directions& directions() const { return directions_; }
  const std::vector<double>& heights() const { return heights_; }

  /// The delta-M truncated medium around a height, with thickness tau.
  TruncatedMedium medium(double height, double tau) const;

  /// Order m of a homogeneous layer; `modes` returns the layer's modes, and is called only if they are needed.
  template <typename Modes>
  ScatteringFunction layer(int m, const TruncatedMedium& seen, const PhaseKernel& phase, const LayerShapes& shapes,
                           const Modes& modes) const {
    // Below this, multiple scattering is lost in rounding.
    constexpr double kFaintest = 1e-7;
    const Eigen::Index n = directions_.live;
    const MultipleScattering multiple =
        seen.albedo * seen.tau > kFaintest
            ? multiple_scattering(modes().layer(seen.tau), seen, phase, m, directions_)
            : MultipleScattering{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd()};
    return layer_on(directions_, multiple, seen, shapes, single_on(directions_, seen, shapes, m), m);
  }

 private:
  GradedMedium medium_;
  std::vector<double> heights_;
  Directions directions_;
};

}  // namespace lamina
