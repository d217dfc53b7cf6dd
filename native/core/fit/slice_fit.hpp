// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fits slices of a scattering function by non-negative mixtures of renderer closures.
//
// A slice is the cosine-weighted function seen from one view column, f(mu_o; mu_i, dphi) mu_i.  All that
// the fit needs of it are inner products over the solid angle of the light: with every closure (`rhs`),
// with itself (`norm2`), and with one (`albedo`).  The inner products of the closures with each other
// (`ColumnGram`) depend on the dictionary alone and are made once.
//
// Slices are independent of each other, and nothing here starts a thread.
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
  double weight = 1.0;  ///< share in the selection's objective
  Eigen::VectorXd rhs;  ///< D
};

struct FitOptions {
  /// Weight of the relative albedo error, squared, against the relative squared L2 error.  What is left
  /// of the albedo error is removed by scaling the mixture.
  double albedo_weight = 1e3;
};

/// Inner products of D closures; `values` is D x G (row = closure, unit weight), `solid_angle` has the
/// G quadrature weights of the light grid.  The albedos are the grid's own sums; closures have kinks, so
/// a caller who wants them exact replaces them by those of a finer grid (divided by `scale`).
[[nodiscard]] ColumnGram column_gram(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                     const Eigen::Ref<const Eigen::VectorXd>& solid_angle);

/// Target for one slice sampled on the light grid of `values`; `albedo` is the slice's exact one.
[[nodiscard]] SliceTarget slice_target(int column, const ColumnGram& gram,
                                       const Eigen::Ref<const Eigen::MatrixXd>& values,
                                       const Eigen::Ref<const Eigen::VectorXd>& solid_angle,
                                       const Eigen::Ref<const Eigen::VectorXd>& slice, double albedo);

/// Fits one slice by the chosen closures.  `weights` (one for each of `chosen`, in 1 per closure of unit
/// weight) is the result; returns the relative L2 error.  The mixture's albedo is the target's exactly,
/// unless all chosen closures are black in this column.
double fit_slice(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                 Eigen::Ref<Eigen::VectorXd> weights, const FitOptions& options = {});

/// The same in unit-norm closures; `x` is warm start and result.  Returns the squared error.
double fit_unit_norm(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                     const FitOptions& options, SmallVector& x);

}  // namespace lamina
