// SPDX-License-Identifier: GPL-3.0-or-later
// Non-negative least squares for few unknowns: the active-set method of Lawson and Hanson (1974, chapter 23) on the
// normal equations, with warm starts and without allocation.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace lamina {

/// Largest number of closures in a mixture; fixed, so that matrices live on the stack.
inline constexpr int kMaxClosures = 24;

/// Matrices and vectors of at most kMaxClosures rows that live on the stack.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxClosures, kMaxClosures>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxClosures, 1>;

// Added to the diagonal of the Gram matrix of unit-norm closures, so that nearly equal closures do not cancel.
inline constexpr double kRidge = 1e-11;
// Gradients below this count as optimal; objectives are of order 1.
inline constexpr double kGradientTolerance = 1e-10;

/// Minimises x'Gx / 2 - b'x over x >= 0 on the normal equations, for unknowns of about unit scale.
/// Holds references to `gram` and `rhs`.
class ActiveSet {
 public:
  ActiveSet(const SmallMatrix& gram, const SmallVector& rhs) : gram_(gram), rhs_(rhs), size_(rhs.size()) {}

  /// `x` is the warm start (its positive entries form the first passive set) and the result.
  void solve(SmallVector& x) {
    count_ = 0;
    for (Eigen::Index k = 0; k < size_; ++k) {
      passive_[static_cast<std::size_t>(k)] = x[k] > 0.0;
      if (!(x[k] > 0.0)) x[k] = 0.0;
    }
    const double tolerance = kGradientTolerance * rhs_.cwiseAbs().maxCoeff();
    move_to_optimum_of_passive_set(x);
    // Each pass lowers the objective, so no passive set recurs; the bound guards against rounding.
    for (Eigen::Index pass = 0; pass < 3 * size_ + 10; ++pass) {
      const Eigen::Index entering = steepest(x, tolerance);
      if (entering < 0) return;
      passive_[static_cast<std::size_t>(entering)] = true;
      move_to_optimum_of_passive_set(x);
      if (!passive_[static_cast<std::size_t>(entering)]) return;
    }
  }

 private:
  // The active unknown whose growth lowers the objective fastest; -1 at the optimum.
  [[nodiscard]] Eigen::Index steepest(const SmallVector& x, double tolerance) const {
    Eigen::Index best = -1;
    double best_gradient = tolerance;
    for (Eigen::Index k = 0; k < size_; ++k) {
      if (passive_[static_cast<std::size_t>(k)] || gram_(k, k) <= 0.0) continue;
      const double gradient = rhs_[k] - gram_.col(k).dot(x);
      if (gradient > best_gradient) {
        best_gradient = gradient;
        best = k;
      }
    }
    return best;
  }

  // Moves towards the unconstrained optimum and drops unknowns that reach zero.
  void move_to_optimum_of_passive_set(SmallVector& x) {
    for (;;) {
      if (!solve_passive()) return;
      double step = 1.0;
      for (Eigen::Index i = 0; i < count_; ++i) {
        const double from = x[index_[static_cast<std::size_t>(i)]];
        if (optimum_[i] <= 0.0) step = std::min(step, from / (from - optimum_[i]));
      }
      bool dropped = false;
      for (Eigen::Index i = 0; i < count_; ++i) {
        const Eigen::Index k = index_[static_cast<std::size_t>(i)];
        const bool reaches_zero = optimum_[i] <= 0.0 && x[k] <= step * (x[k] - optimum_[i]) * (1.0 + 1e-12);
        x[k] = reaches_zero ? 0.0 : std::max(0.0, x[k] + step * (optimum_[i] - x[k]));
        if (reaches_zero) {
          passive_[static_cast<std::size_t>(k)] = false;
          dropped = true;
        }
      }
      if (!dropped) return;
    }
  }

  // Cholesky on the passive rows; false when the passive set is empty.
  bool solve_passive() {
    count_ = 0;
    for (Eigen::Index k = 0; k < size_; ++k)
      if (passive_[static_cast<std::size_t>(k)]) index_[static_cast<std::size_t>(count_++)] = k;
    if (count_ == 0) return false;
    optimum_.resize(count_);
    factor_.resize(count_, count_);
    for (Eigen::Index j = 0; j < count_; ++j) {
      const Eigen::Index column = index_[static_cast<std::size_t>(j)];
      for (Eigen::Index i = j; i < count_; ++i) factor_(i, j) = gram_(index_[static_cast<std::size_t>(i)], column);
      factor_(j, j) *= 1.0 + kRidge;
      optimum_[j] = rhs_[column];
    }
    factorise();
    for (Eigen::Index i = 0; i < count_; ++i) {
      double sum = optimum_[i];
      for (Eigen::Index j = 0; j < i; ++j) sum -= factor_(i, j) * optimum_[j];
      optimum_[i] = sum * inverse_diagonal_[i];
    }
    for (Eigen::Index i = count_; i-- > 0;) {
      double sum = optimum_[i];
      for (Eigen::Index j = i + 1; j < count_; ++j) sum -= factor_(j, i) * optimum_[j];
      optimum_[i] = sum * inverse_diagonal_[i];
    }
    return true;
  }

  // In place, lower triangle; at these sizes a plain loop is faster than a general routine.
  void factorise() {
    inverse_diagonal_.resize(count_);
    for (Eigen::Index j = 0; j < count_; ++j) {
      double pivot = factor_(j, j);
      const double floor = kRidge * std::max(pivot, 1e-300);
      for (Eigen::Index k = 0; k < j; ++k) pivot -= factor_(j, k) * factor_(j, k);
      const double inverse = 1.0 / std::sqrt(std::max(pivot, floor));
      inverse_diagonal_[j] = inverse;
      for (Eigen::Index i = j + 1; i < count_; ++i) {
        double sum = factor_(i, j);
        for (Eigen::Index k = 0; k < j; ++k) sum -= factor_(i, k) * factor_(j, k);
        factor_(i, j) = sum * inverse;
      }
    }
  }

  const SmallMatrix& gram_;
  const SmallVector& rhs_;
  Eigen::Index size_;
  Eigen::Index count_ = 0;
  std::array<bool, kMaxClosures> passive_{};
  std::array<Eigen::Index, kMaxClosures> index_{};
  SmallMatrix factor_;
  SmallVector optimum_;
  SmallVector inverse_diagonal_;
};

}  // namespace lamina
