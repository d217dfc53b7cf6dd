// SPDX-License-Identifier: GPL-3.0-or-later
// Quadrature nodes and target directions of the media of a stack, matched by Snell's law.
#pragma once
#include <Eigen/Core>
#include <map>
#include <memory>
#include <vector>

#include "numeric/quadrature.hpp"

namespace lamina {

/// The directions of one medium, in a stack whose media may differ in refractive index.
///
/// Snell's law keeps n sin(theta), so a ray has one number in all media: direction k here is direction k
/// everywhere. The first `live` of all nodes exist in this medium; the rest would need n sin(theta) > n and
/// belong to denser media. Behind the nodes come *targets*, where functions are wanted but which no
/// integral sees (Nystrom's interpolation); they are given in air.
///
/// Radiance is carried divided by n^2, which refraction keeps, and scaled by n sqrt(2 mu w) = C, which is
/// the same in all media (1 at targets). A kernel pi * BRDF becomes the matrix scale_i pi f_ij scale_j with
/// scale = C / n: symmetric for a reciprocal layer, and matrix products are the integrals.
struct Directions {
  double ior = 1.0;
  Eigen::Index nodes = 0;  ///< of the whole stack, live or not
  Eigen::Index live = 0;   ///< nodes that exist in this medium; they come first
  Eigen::Index targets = 0;
  Eigen::Index views = -1;        ///< how many of the targets are views, the rest being lights; -1: each is both
  Eigen::VectorXd mu;             ///< of the live nodes, then of the targets
  Eigen::VectorXd weight;         ///< of the live nodes
  Eigen::VectorXd scale;          ///< as mu
  Eigen::MatrixXd interpolation;  ///< from the live nodes to live nodes and targets

  Eigen::Index size() const { return nodes + targets; }

  /// A matrix over live nodes and targets as one over all directions, zero where there is none.
  Eigen::MatrixXd spread(const Eigen::MatrixXd& compact) const;
  Eigen::VectorXd spread(const Eigen::VectorXd& compact) const;
};

/// The quadrature of a whole stack: Gauss-Legendre nodes on each range of n sin(theta) that begins where a
/// medium of lower index ends, in the cosine of the least dense medium that has the range, so that
/// functions are smooth through grazing incidence and the critical angle. In layers thinner than the
/// cosines that the nodes resolve, light streams sideways: there the grazing end of each range is divided
/// further, down to cosines like the thickness. Only where it is needed: in a denser medium the same cosines would
/// fall together at the critical angle, and rounding would not tell them apart.
class DirectionSet {
 public:
  /// `indices`: refractive indices in the stack, in any order; `count`: nodes of a range of cosines from 0 to
  /// 1; `thinnest`: by refractive index, the least optical thickness of a layer that scatters repeatedly.
  DirectionSet(std::vector<double> indices, int count, const std::map<double, double>& thinnest);

  /// The same ranges with as many times more nodes.
  DirectionSet finer_by(double factor) const;
  /// From this set's nodes to those of a finer one: polynomial interpolation of scaled radiance, which keeps
  /// scalar products and fluxes. Finer nodes by nodes.
  Eigen::MatrixXd carry_to(const DirectionSet& fine) const;

  Directions in_medium(double ior, const Eigen::VectorXd& targets_in_air) const;
  double moment_error() const;

  /// Nodes of one range: cosines in the least dense medium that has them, of index `ior`.
  struct Range {
    double ior;
    Quadrature nodes;
  };
  const std::vector<Range>& ranges() const { return ranges_; }

 private:
  const Range& range_of(double mu_in_air, Eigen::Index& first) const;

  std::vector<Range> ranges_;  // indices ascending, then cosines
};

/// The cosine in a medium of the ray whose cosine in air is `mu`; light in air always gets in.
double refracted_cosine(double mu, double from_ior, double to_ior);

}  // namespace lamina
