// SPDX-License-Identifier: GPL-3.0-or-later
#include "closure_fit.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace lamina {
namespace {

using Eigen::Index;
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxClosures, kMaxClosures>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxClosures, 1>;

// Closures of unit norm: a diagonal this much heavier keeps nearly equal closures from cancelling.
constexpr double kRidge = 1e-11;
constexpr double kGradientTolerance = 1e-10;

// Active-set solver on a problem of at most kMaxClosures unknowns, without allocation.
class ActiveSet {
 public:
  ActiveSet(const SmallMatrix& gram, const SmallVector& rhs) : gram_(gram), rhs_(rhs), size_(rhs.size()) {}

  void solve(SmallVector& x) {
    count_ = 0;
    for (Index k = 0; k < size_; ++k) {
      passive_[static_cast<std::size_t>(k)] = x[k] > 0.0;
      if (!(x[k] > 0.0)) x[k] = 0.0;
    }
    const double tolerance = kGradientTolerance * rhs_.cwiseAbs().maxCoeff();
    move_to_optimum_of_passive_set(x);
    // Each pass lowers the objective, so no passive set comes back; the bound guards against round-off.
    for (Index pass = 0; pass < 3 * size_ + 10; ++pass) {
      const Index entering = steepest(x, tolerance);
      if (entering < 0) return;
      passive_[static_cast<std::size_t>(entering)] = true;
      move_to_optimum_of_passive_set(x);
      if (!passive_[static_cast<std::size_t>(entering)]) return;
    }
  }

 private:
  // The active unknown whose growth lowers the objective fastest; -1 at the optimum.
  [[nodiscard]] Index steepest(const SmallVector& x, double tolerance) const {
    Index best = -1;
    double best_gradient = tolerance;
    for (Index k = 0; k < size_; ++k) {
      if (passive_[static_cast<std::size_t>(k)] || gram_(k, k) <= 0.0) continue;
      const double gradient = rhs_[k] - gram_.col(k).dot(x);
      if (gradient > best_gradient) {
        best_gradient = gradient;
        best = k;
      }
    }
    return best;
  }

  // Steps towards the unconstrained optimum, dropping unknowns that reach zero on the way.
  void move_to_optimum_of_passive_set(SmallVector& x) {
    for (;;) {
      if (!solve_passive()) return;
      double step = 1.0;
      for (Index i = 0; i < count_; ++i) {
        const double from = x[index_[static_cast<std::size_t>(i)]];
        if (optimum_[i] <= 0.0) step = std::min(step, from / (from - optimum_[i]));
      }
      bool dropped = false;
      for (Index i = 0; i < count_; ++i) {
        const Index k = index_[static_cast<std::size_t>(i)];
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
    for (Index k = 0; k < size_; ++k)
      if (passive_[static_cast<std::size_t>(k)]) index_[static_cast<std::size_t>(count_++)] = k;
    if (count_ == 0) return false;
    optimum_.resize(count_);
    factor_.resize(count_, count_);
    for (Index j = 0; j < count_; ++j) {
      const Index column = index_[static_cast<std::size_t>(j)];
      for (Index i = j; i < count_; ++i) factor_(i, j) = gram_(index_[static_cast<std::size_t>(i)], column);
      factor_(j, j) *= 1.0 + kRidge;
      optimum_[j] = rhs_[column];
    }
    factorise();
    for (Index i = 0; i < count_; ++i) {
      double sum = optimum_[i];
      for (Index j = 0; j < i; ++j) sum -= factor_(i, j) * optimum_[j];
      optimum_[i] = sum * inverse_diagonal_[i];
    }
    for (Index i = count_; i-- > 0;) {
      double sum = optimum_[i];
      for (Index j = i + 1; j < count_; ++j) sum -= factor_(j, i) * optimum_[j];
      optimum_[i] = sum * inverse_diagonal_[i];
    }
    return true;
  }

  // In place, lower triangle; a plain loop beats a general routine at these sizes.
  void factorise() {
    inverse_diagonal_.resize(count_);
    for (Index j = 0; j < count_; ++j) {
      double pivot = factor_(j, j);
      const double floor = kRidge * std::max(pivot, 1e-300);
      for (Index k = 0; k < j; ++k) pivot -= factor_(j, k) * factor_(j, k);
      const double inverse = 1.0 / std::sqrt(std::max(pivot, floor));
      inverse_diagonal_[j] = inverse;
      for (Index i = j + 1; i < count_; ++i) {
        double sum = factor_(i, j);
        for (Index k = 0; k < j; ++k) sum -= factor_(i, k) * factor_(j, k);
        factor_(i, j) = sum * inverse;
      }
    }
  }

  const SmallMatrix& gram_;
  const SmallVector& rhs_;
  Index size_;
  Index count_ = 0;
  std::array<bool, kMaxClosures> passive_{};
  std::array<Index, kMaxClosures> index_{};
  SmallMatrix factor_;
  SmallVector optimum_;
  SmallVector inverse_diagonal_;
};

// Solves one slice in the unit-norm closures; `x` is warm start and result.  Returns the squared
// relative error of the mixture *after* it is scaled to the exact albedo.
double fit_unit_norm(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                     const FitOptions& options, SmallVector& x) {
  const auto size = static_cast<Index>(chosen.size());
  if (!(target.norm2 > 0.0)) {
    x.setZero(size);
    return 0.0;
  }
  SmallMatrix matrix(size, size);
  SmallVector rhs(size);
  SmallVector albedo(size);
  for (Index j = 0; j < size; ++j) {
    const Index column = chosen[static_cast<std::size_t>(j)];
    for (Index i = 0; i < size; ++i) matrix(i, j) = gram.gram(chosen[static_cast<std::size_t>(i)], column);
    rhs[j] = target.rhs[column];
    albedo[j] = gram.albedo[column];
  }
  SmallMatrix plain = matrix;
  const SmallVector plain_rhs = rhs;
  // The albedo row, weighted relative to the slice: lambda (a.x - A)^2 with lambda = W norm2 / A^2.
  const bool has_albedo = target.albedo > 0.0;
  if (has_albedo) {
    const double lambda = options.albedo_weight * target.norm2 / (target.albedo * target.albedo);
    matrix.noalias() += lambda * albedo * albedo.transpose();
    rhs += lambda * target.albedo * albedo;
  }
  ActiveSet(matrix, rhs).solve(x);
  if (has_albedo) {
    const double reached = albedo.dot(x);
    if (reached > 0.0) x *= target.albedo / reached;
  }
  const double squared = target.norm2 - 2.0 * plain_rhs.dot(x) + x.dot(plain * x);
  return std::max(0.0, squared / target.norm2);
}

// The objective of a set of closures over all slices.
struct Score {
  double objective = std::numeric_limits<double>::infinity();
  double mean_error = 0.0;
  double worst_error = 0.0;
};

class Selector {
 public:
  Selector(std::span<const ColumnGram> grams, std::span<const SliceTarget> targets, const SelectionOptions& options,
           std::span<const int> candidates, std::span<const int> fixed, const ParallelFor& parallel_for)
      : grams_(grams),
        targets_(targets),
        options_(options),
        candidates_(candidates.begin(), candidates.end()),
        fixed_(fixed.begin(), fixed.end()),
        chosen_(fixed_),
        parallel_for_(parallel_for) {
    if (candidates_.empty() && !grams.empty()) {
      candidates_.resize(static_cast<std::size_t>(grams[0].scale.size()));
      std::iota(candidates_.begin(), candidates_.end(), 0);
    }
    for (const SliceTarget& target : targets_) total_weight_ += target.weight;
  }

  Selection run() {
    const auto wanted = static_cast<std::size_t>(options_.closures);
    const std::size_t most = std::min<std::size_t>(
        {wanted + static_cast<std::size_t>(std::max(0, options_.overshoot)), kMaxClosures, candidates_.size()});
    refit();
    bool enough = reached_target();
    while (!enough && chosen_.size() < wanted && add_best()) enough = reached_target();
    if (!enough) {
      while (chosen_.size() < most && add_best()) {
      }
      while (chosen_.size() > wanted && remove_least_useful()) {
      }
    }
    for (int pass = 0; pass < options_.swap_passes && exchange_each(); ++pass) {
    }
    Selection result;
    result.closures = chosen_;
    std::sort(result.closures.begin(), result.closures.end());
    result.mean_error = score_.mean_error;
    result.worst_error = score_.worst_error;
    return result;
  }

 private:
  [[nodiscard]] bool reached_target() const { return !chosen_.empty() && score_.mean_error < options_.target_error; }

  [[nodiscard]] double penalty(std::span<const int> set) const {
    double product = 1.0;
    if (!options_.penalty.empty())
      for (const int closure : set) product *= options_.penalty[static_cast<std::size_t>(closure)];
    return product;
  }

  [[nodiscard]] bool is_chosen(int closure) const {
    return std::find(chosen_.begin(), chosen_.end(), closure) != chosen_.end();
  }

  // Scores `chosen_` with one more closure, or with `replaced` (a position) exchanged for it.
  [[nodiscard]] Score score_with(int closure, int replaced) const {
    std::array<int, kMaxClosures + 1> buffer{};
    std::copy(chosen_.begin(), chosen_.end(), buffer.begin());
    std::size_t count = chosen_.size();
    if (replaced < 0) buffer[count++] = closure;
    else buffer[static_cast<std::size_t>(replaced)] = closure;
    return score(std::span<const int>(buffer.data(), count), replaced);
  }

  // `changed` is the position whose warm start is void; -1: the last one, which has none.
  [[nodiscard]] Score score(std::span<const int> set, int changed) const {
    Score result;
    const double factor = penalty(set);
    double sum2 = 0.0;
    double sum = 0.0;
    double worst2 = 0.0;
    SmallVector x(static_cast<Index>(set.size()));
    for (std::size_t s = 0; s < targets_.size(); ++s) {
      const SliceTarget& target = targets_[s];
      for (Index k = 0; k < x.size(); ++k) x[k] = k < fits_[s].size() && k != changed ? fits_[s][k] : 0.0;
      const double error2 =
          fit_unit_norm(grams_[static_cast<std::size_t>(target.column)], target, set, options_.fit, x);
      sum2 += target.weight * error2;
      sum += target.weight * std::sqrt(error2);
      worst2 = std::max(worst2, error2);
      // Nothing can undercut the best any more: the rest only adds.
      if (sum2 / total_weight_ * factor > abandon_above_) return result;
    }
    result.objective = factor * (sum2 / total_weight_ + options_.worst_share * worst2);
    result.mean_error = sum / total_weight_;
    result.worst_error = std::sqrt(worst2);
    return result;
  }

  // Fits every slice with the closures chosen so far, for warm starts.
  void refit() {
    fits_.assign(targets_.size(), SmallVector::Zero(static_cast<Index>(chosen_.size())));
    if (chosen_.empty()) {
      score_ = {};
      return;
    }
    for (std::size_t s = 0; s < targets_.size(); ++s)
      fit_unit_norm(grams_[static_cast<std::size_t>(targets_[s].column)], targets_[s], chosen_, options_.fit, fits_[s]);
    abandon_above_ = std::numeric_limits<double>::infinity();
    score_ = score(chosen_, static_cast<int>(chosen_.size()));
  }

  // The candidate that makes the best set when added (replaced < 0) or exchanged for a position.
  [[nodiscard]] std::pair<int, double> best_candidate(int replaced) {
    std::vector<int> open;
    for (const int closure : candidates_)
      if (!is_chosen(closure)) open.push_back(closure);
    std::vector<double> objective(open.size(), std::numeric_limits<double>::infinity());
    abandon_above_ = replaced < 0 ? std::numeric_limits<double>::infinity() : score_.objective;
    for_each(static_cast<int>(open.size()), [&](int i) {
      objective[static_cast<std::size_t>(i)] = score_with(open[static_cast<std::size_t>(i)], replaced).objective;
    });
    const auto best = std::min_element(objective.begin(), objective.end());
    if (best == objective.end() || !std::isfinite(*best)) return {-1, std::numeric_limits<double>::infinity()};
    return {open[static_cast<std::size_t>(best - objective.begin())], *best};
  }

  bool add_best() {
    const auto [closure, objective] = best_candidate(-1);
    if (closure < 0 || (!chosen_.empty() && objective >= score_.objective)) return false;
    chosen_.push_back(closure);
    refit();
    return true;
  }

  bool remove_least_useful() {
    abandon_above_ = std::numeric_limits<double>::infinity();
    std::vector<double> objective(chosen_.size(), std::numeric_limits<double>::infinity());
    const std::vector<int> all = chosen_;
    for (std::size_t k = fixed_.size(); k < all.size(); ++k) {
      chosen_ = all;
      chosen_.erase(chosen_.begin() + static_cast<std::ptrdiff_t>(k));
      refit();
      objective[k] = score_.objective;
    }
    const auto best = std::min_element(objective.begin(), objective.end());
    chosen_ = all;
    const bool found = best != objective.end() && std::isfinite(*best);
    if (found) chosen_.erase(chosen_.begin() + (best - objective.begin()));
    refit();
    return found;
  }

  bool exchange_each() {
    bool improved = false;
    for (std::size_t k = fixed_.size(); k < chosen_.size(); ++k) {
      const auto [closure, objective] = best_candidate(static_cast<int>(k));
      if (closure >= 0 && objective < score_.objective * (1.0 - 1e-6)) {
        chosen_[k] = closure;
        refit();
        improved = true;
      }
    }
    return improved;
  }

  void for_each(int count, const std::function<void(int)>& body) const {
    if (parallel_for_) {
      parallel_for_(count, body);
      return;
    }
    for (int i = 0; i < count; ++i) body(i);
  }

  std::span<const ColumnGram> grams_;
  std::span<const SliceTarget> targets_;
  const SelectionOptions& options_;
  std::vector<int> candidates_;
  std::vector<int> fixed_;
  std::vector<int> chosen_;
  const ParallelFor& parallel_for_;
  std::vector<SmallVector> fits_;
  Score score_;
  double total_weight_ = 0.0;
  double abandon_above_ = std::numeric_limits<double>::infinity();
};

}  // namespace

void nnls(const Eigen::Ref<const Eigen::MatrixXd>& gram, const Eigen::Ref<const Eigen::VectorXd>& rhs,
          Eigen::Ref<Eigen::VectorXd> x) {
  if (rhs.size() > kMaxClosures) throw std::invalid_argument("nnls: more unknowns than kMaxClosures");
  const SmallMatrix small_gram = gram;
  const SmallVector small_rhs = rhs;
  SmallVector small_x = x;
  ActiveSet(small_gram, small_rhs).solve(small_x);
  x = small_x;
}

ColumnGram column_gram(const Eigen::Ref<const Eigen::MatrixXd>& values,
                       const Eigen::Ref<const Eigen::VectorXd>& solid_angle) {
  ColumnGram result;
  const Eigen::MatrixXd weighted = values * solid_angle.asDiagonal();
  result.gram.noalias() = weighted * values.transpose();
  result.scale = result.gram.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (result.scale.array() > 0.0).select(result.scale.cwiseInverse(), 0.0);
  result.gram = inverse.asDiagonal() * result.gram * inverse.asDiagonal();
  result.albedo = (values * solid_angle).cwiseProduct(inverse);
  return result;
}

SliceTarget slice_target(int column, const ColumnGram& gram, const Eigen::Ref<const Eigen::MatrixXd>& values,
                         const Eigen::Ref<const Eigen::VectorXd>& solid_angle,
                         const Eigen::Ref<const Eigen::VectorXd>& slice, double albedo) {
  SliceTarget target;
  target.column = column;
  const Eigen::VectorXd weighted = slice.cwiseProduct(solid_angle);
  target.norm2 = weighted.dot(slice);
  target.albedo = albedo < 0.0 ? weighted.sum() : albedo;
  target.rhs = values * weighted;
  for (Index k = 0; k < target.rhs.size(); ++k)
    target.rhs[k] = gram.scale[k] > 0.0 ? target.rhs[k] / gram.scale[k] : 0.0;
  return target;
}

double fit_slice(const ColumnGram& gram, const SliceTarget& target, std::span<const int> chosen,
                 Eigen::Ref<Eigen::VectorXd> weights, const FitOptions& options) {
  if (chosen.size() > static_cast<std::size_t>(kMaxClosures))
    throw std::invalid_argument("fit_slice: more closures than kMaxClosures");
  SmallVector x = SmallVector::Zero(static_cast<Index>(chosen.size()));
  const double squared = fit_unit_norm(gram, target, chosen, options, x);
  for (Index k = 0; k < x.size(); ++k) {
    const double scale = gram.scale[chosen[static_cast<std::size_t>(k)]];
    weights[k] = scale > 0.0 ? x[k] / scale : 0.0;
  }
  return std::sqrt(squared);
}

Selection select_closures(std::span<const ColumnGram> grams, std::span<const SliceTarget> targets,
                          const SelectionOptions& options, std::span<const int> candidates, std::span<const int> fixed,
                          const ParallelFor& parallel_for) {
  if (options.closures < 1 || options.closures > kMaxClosures ||
      fixed.size() > static_cast<std::size_t>(options.closures))
    throw std::invalid_argument("select_closures: number of closures out of range");
  return Selector(grams, targets, options, candidates, fixed, parallel_for).run();
}

}  // namespace lamina
