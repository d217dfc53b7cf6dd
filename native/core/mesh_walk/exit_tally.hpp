// SPDX-License-Identifier: GPL-3.0-or-later
// Tallies the exit albedo of a solid, and the distance between entry and exit.
#pragma once
#include <array>

#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// Sums over the samples from one point, per channel: w is the weight at the first exit, r the straight distance in mm
/// from start to exit. A sample's w, w r and w r^2 are means over its paths.
struct ExitSums {
  enum Score { kWeight, kDistance, kSquare, kScores };
  struct OfChannel {
    /// Sums of v = (w, w r, w r^2), and of the products v_i v_j, i <= j, by rows.
    std::array<double, kScores> moments = {};
    std::array<double, kScores*(kScores + 1) / 2> products = {};
  };
  std::array<OfChannel, kChannels> channels;

  void add(const ExitSums& other);
};

/// Records the first exit of each path.
class ExitTally final : public WalkListener {
 public:
  explicit ExitTally(ExitSums& sums) : sums_(sums) {}

  void begin(const Place& start) { start_ = start; }
  bool leaves(const Exit& exit) override;
  /// Ends a sample.
  void finish();

 private:
  ExitSums& sums_;
  Place start_;
  std::array<std::array<double, ExitSums::kScores>, kChannels> found_ = {};  ///< of the current sample, by channel
};

}  // namespace lamina
