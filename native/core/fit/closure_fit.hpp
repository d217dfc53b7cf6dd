// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the few closures whose mixtures fit all slices of a material best: forward greedy, elimination, then
// exchange. Every trial set is scored by the non-negative fit of all slices.
#pragma once

#include "fit/slice_fit.hpp"

#include <functional>
#include <span>
#include <vector>

namespace lamina {

struct SelectionOptions {
  int closures = 6;             ///< number to choose, at most `kMaxClosures`
  double target_error = 0.0;    ///< stop earlier when the mean relative error is below this
  double worst_share = 0.05;    ///< share of the worst slice's squared error in the objective
  int overshoot = 2;            ///< closures added beyond `closures` before elimination
  int swap_passes = 2;          ///< rounds of exchanging one closure for a better one
  std::vector<double> penalty;  ///< D or empty: factor (>= 1) on the objective for choosing a noisy or slow closure
  FitOptions fit;
};

struct Selection {
  std::vector<int> closures;  ///< indices into the dictionary, ascending
  double mean_error = 0.0;    ///< mean of the slices' relative L2 errors, each times the root of the slice's weight
  double worst_error = 0.0;
};

/// Runs body(0), ..., body(count - 1) in any order, perhaps on several threads, and waits for all.
using ParallelFor = std::function<void(int count, const std::function<void(int)>& body)>;

/// Chooses closures for all slices together: forward greedy, elimination, then exchange.
/// `candidates` are indices into the dictionary (empty: all of it); those in `fixed` are always chosen.
[[nodiscard]] Selection select_closures(std::span<const ColumnGram> grams, std::span<const SliceTarget> targets,
                                        const SelectionOptions& options, std::span<const int> candidates = {},
                                        std::span<const int> fixed = {}, const ParallelFor& parallel_for = {});

}  // namespace lamina
