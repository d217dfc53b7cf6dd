// SPDX-License-Identifier: GPL-3.0-or-later
// Fits slices of a scattering function by non-negative mixtures of renderer closures.
//
// A slice is the cosine-weighted function for one view column, f(mu_o; mu_i, dphi) mu_i. The fit needs only its inner
// products over the solid angle of the light: with every closure (`rhs`), with itself (`norm2`), and with 1 (`albedo`).
// The inner products of the closures with each other (`ColumnGram`) depend on the dictionary alone.
#pragma once

#include "numeric/nnls.hpp"

#include <Eigen/Core>

#include <span>

namespace lamina {

/// Inner products of the closures of one view column, closures scaled to unit norm.
struct ColumnGram {
  Eigen::MatrixXd gram;    ///< D x D, unit diagonal (zero for a closure that is black here)
  Eigen::VectorXd scale;   ///< D, norm of each closure over the solid angle; 0 if it is black here
  Eigen::VectorXd albedo;  ///< D, directional albedo of each closure divided by its norm
};

/// One slice to be fitted; `rhs` is divided by the closures' norms, as `ColumnGram` is.
struct SliceTarget {
  int column = 0;       ///< index into the column Grams
  double norm2 = 0.0;   ///< squared norm of the slice
  double albedo = 0.0;  ///< exact directional albedo
  double weight = 1.0;  ///< factor of the squared relative error in a choice of closures
  Eigen::VectorXd rhs;  ///< D
};

struct FitOptions {
  /// Weight of the squared relative albedo error against the squared relative L2 error. Scaling the mixture removes
  /// the remaining albedo error.
  double albedo_weight = 1e3;
};

/// Inner products of D closures. `values` is D x G (row = closure, unit weight); `solid_angle` holds the G quadrature
/// weights of the light grid. The albedos are sums on this grid; callers may replace them by those of a finer grid,
/// divided by `scale`, since closures have kinks.
[[nodiscard]] ColumnGram column_gram(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                     const Eigen::Ref<const Eigen::VectorXd>& solid_angle);

/// Target for one slice sampled on the light grid of `values`; `albedo` is the slice's exact albedo.
[[nodiscard]] SliceTarget slice_target(int column, const ColumnGram& gram,
                                       const Eigen::Ref<const Eigen::MatrixXd>& values,
                                       const Eigen::Ref<const Eigen::VectorXd>& solid_angle,
                                       const Eigen::Ref<const Eigen::VectorXd>& slice, double albedo);

/// Fits one slice by the chosen closures. Writes one weight per chosen closure to `weights` and returns the relative L2
/// error. The mixture has exactly the target's albedo, unless all chosen closures are black in this column.
double fit_slice(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                 Eigen::Ref<Eigen::VectorXd> weights, const FitOptions& options = {});

/// The same for closures of unit norm; `x` is the warm start and the result. Returns the squared error.
double fit_unit_norm(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                     const FitOptions& options, SmallVector& x);

}  // namespace lamina
