// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/closure_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace lamina {
namespace {

using Eigen::Index;

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

  // `changed` is the position whose warm start is invalid; -1: the last one.
  [[nodiscard]] Score score(std::span<const int> set, int changed) const {
    Score result;
    const double factor = penalty(set);
    const auto count = static_cast<double>(targets_.size());
    double sum2 = 0.0;
    double sum = 0.0;
    double worst2 = 0.0;
    SmallVector x(static_cast<Index>(set.size()));
    for (std::size_t s = 0; s < targets_.size(); ++s) {
      const SliceTarget& target = targets_[s];
      for (Index k = 0; k < x.size(); ++k) x[k] = k < fits_[s].size() && k != changed ? fits_[s][k] : 0.0;
      const double error2 =
          target.weight * fit_unit_norm(grams_[static_cast<std::size_t>(target.column)], target, set, options_.fit, x);
      sum2 += error2;
      sum += std::sqrt(error2);
      worst2 = std::max(worst2, error2);
      // The sum already exceeds the best; the remaining terms are positive.
      if (sum2 / count * factor > abandon_above_) return result;
    }
    result.objective = factor * (sum2 / count + options_.worst_share * worst2);
    result.mean_error = sum / count;
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

  // The candidate that gives the best set when added (replaced < 0) or exchanged for a position.
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
  double abandon_above_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Selection select_closures(std::span<const ColumnGram> grams, std::span<const SliceTarget> targets,
                          const SelectionOptions& options, std::span<const int> candidates, std::span<const int> fixed,
                          const ParallelFor& parallel_for) {
  if (options.closures < 1 || options.closures > kMaxClosures ||
      fixed.size() > static_cast<std::size_t>(options.closures))
    throw std::invalid_argument("select_closures: number of closures out of range");
  return Selector(grams, targets, options, candidates, fixed, parallel_for).run();
}

}  // namespace lamina
