// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fits slices of a scattering function by non-negative mixtures of renderer closures.
//
// A slice is the cosine-weighted function seen from one view column, f(mu_o; mu_i, dphi) mu_i.  All that
// the fit needs of it are inner products over the solid angle of the light: with every closure (`rhs`),
// with itself (`norm2`), and with one (`albedo`).  The inner products of the closures with each other
// (`ColumnGram`) depend on the dictionary alone and are made once.
//
// Nothing here starts a thread: `fit_slice` is independent for every slice, and `select_closures` hands
// its inner loop to the caller's `ParallelFor`.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lamina {

/// Most closures that one mixture may hold; keeps the small linear algebra on the stack.
inline constexpr int kMaxClosures = 24;

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

struct SelectionOptions {
  int closures = 6;             ///< how many to choose, at most `kMaxClosures`
  double target_error = 0.0;    ///< stop earlier when the mean relative error is below this
  double worst_share = 0.05;    ///< share of the worst slice's squared error in the objective
  int overshoot = 2;            ///< closures added beyond `closures`, then eliminated again
  int swap_passes = 2;          ///< rounds of exchanging one closure for a better one
  std::vector<double> penalty;  ///< D or empty: factor (>= 1) on the objective for choosing a noisy or slow closure
  FitOptions fit;
};

struct Selection {
  std::vector<int> closures;  ///< indices into the dictionary, ascending
  double mean_error = 0.0;    ///< weighted mean of the slices' relative L2 errors
  double worst_error = 0.0;
};

/// Runs body(0), ..., body(count - 1) in any order, perhaps on several threads, and waits for all.
using ParallelFor = std::function<void(int count, const std::function<void(int)>& body)>;

/// Minimises x'Gx / 2 - b'x over x >= 0 (Lawson and Hanson's active set on the normal equations).
/// `x` is read as a warm start: its positive entries form the first passive set.  K <= kMaxClosures.
void nnls(const Eigen::Ref<const Eigen::MatrixXd>& gram, const Eigen::Ref<const Eigen::VectorXd>& rhs,
          Eigen::Ref<Eigen::VectorXd> x);

/// Inner products of D closures; `values` is D x G (row = closure, unit weight), `solid_angle` has the
/// G quadrature weights of the light grid.
[[nodiscard]] ColumnGram column_gram(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                     const Eigen::Ref<const Eigen::VectorXd>& solid_angle);

/// Target for one slice sampled on the light grid of `values`.  `albedo` < 0 takes the grid's own sum.
[[nodiscard]] SliceTarget slice_target(int column, const ColumnGram& gram,
                                       const Eigen::Ref<const Eigen::MatrixXd>& values,
                                       const Eigen::Ref<const Eigen::VectorXd>& solid_angle,
                                       const Eigen::Ref<const Eigen::VectorXd>& slice, double albedo = -1.0);

/// Fits one slice by the chosen closures.  `weights` (one for each of `chosen`, in 1 per closure of unit
/// weight) is the result; returns the relative L2 error.  The mixture's albedo is the target's exactly,
/// unless all chosen closures are black in this column.
double fit_slice(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                 Eigen::Ref<Eigen::VectorXd> weights, const FitOptions& options = {});

/// Chooses closures for all slices together: forward greedy, elimination, then exchange.
/// `candidates` are indices into the dictionary (empty: all of it); `fixed` are always part.
[[nodiscard]] Selection select_closures(std::span<const ColumnGram> grams, std::span<const SliceTarget> targets,
                                        const SelectionOptions& options, std::span<const int> candidates = {},
                                        std::span<const int> fixed = {}, const ParallelFor& parallel_for = {});

}  // namespace lamina
