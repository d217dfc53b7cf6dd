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
/// Snell's law conserves n sin(theta), so direction k is the same ray in all media. The first `live` nodes exist in
/// this medium; the others have n sin(theta) > n and belong to denser media. The nodes are followed by targets:
/// directions, given in air, at which functions are evaluated but not integrated (Nystrom interpolation).
///
/// Stored radiance is divided by n^2, which refraction conserves, and multiplied by C = n sqrt(2 mu w), which is the
/// same in all media (1 at targets). A kernel pi * BRDF becomes the matrix scale_i pi f_ij scale_j with scale = C / n.
/// The matrix is symmetric for a reciprocal layer, and matrix products are integrals.
struct Directions {
  double ior = 1.0;
  Eigen::Index nodes = 0;  ///< of the whole stack, live or not
  Eigen::Index live = 0;   ///< nodes that exist in this medium; they come first
  Eigen::Index targets = 0;
  Eigen::Index views = -1;        ///< number of targets that are views, the others are lights; -1: each is both
  Eigen::VectorXd mu;             ///< of the live nodes, then of the targets
  Eigen::VectorXd weight;         ///< of the live nodes
  Eigen::VectorXd scale;          ///< of the live nodes, then of the targets
  Eigen::MatrixXd interpolation;  ///< from the live nodes to live nodes and targets

  Eigen::Index size() const { return nodes + targets; }

  /// Extends a matrix over live nodes and targets to all directions, with zeros.
  Eigen::MatrixXd spread(const Eigen::MatrixXd& compact) const;
  Eigen::VectorXd spread(const Eigen::VectorXd& compact) const;
};

/// The quadrature of a stack. n sin(theta) is divided into ranges at the refractive indices of the media. Each range
/// has Gauss-Legendre nodes in the cosine of the least dense medium that contains it, so that functions are smooth at
/// grazing incidence and at the critical angle. For thin layers the grazing end of a range is divided further, down to
/// cosines similar to the thickness. Other ranges are not divided: in a denser medium these cosines would coincide at
/// the critical angle within rounding.
class DirectionSet {
 public:
  /// `indices`: refractive indices in the stack, in any order; `count`: nodes of a range of cosines from 0 to 1;
  /// `thinnest`: by refractive index, the least optical thickness of a layer with multiple scattering.
  DirectionSet(std::vector<double> indices, int count, const std::map<double, double>& thinnest);

  /// The same ranges with a multiple of the nodes.
  DirectionSet finer_by(double factor) const;
  /// The same set, with a separate range of `nodes` nodes for cosines above `division` in the least dense medium.
  DirectionSet divided(double division, int nodes) const;
  /// Interpolates scaled radiance from this set's nodes to those of a finer set, by polynomials that conserve scalar
  /// products and fluxes. [finer node, node].
  Eigen::MatrixXd carry_to(const DirectionSet& fine) const;

  Directions in_medium(double ior, const Eigen::VectorXd& targets_in_air) const;
  double moment_error() const;
  /// Cosines in a medium where ranges of nodes end, 0 first.
  std::vector<double> ends(double ior) const;

  /// The nodes of one range: cosines in the least dense medium that contains it, of index `ior`.
  struct Range {
    double ior;
    Quadrature nodes;
  };
  const std::vector<Range>& ranges() const { return ranges_; }

 private:
  const Range& range_of(double mu_in_air, Eigen::Index& first) const;

  std::vector<Range> ranges_;  // indices ascending, then cosines
};

/// The cosine in a medium of the ray with cosine `mu` in air.
double refracted_cosine(double mu, double from_ior, double to_ior);

}  // namespace lamina
