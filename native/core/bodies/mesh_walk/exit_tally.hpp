// SPDX-License-Identifier: GPL-3.0-or-later
// Tallies the exit albedo of a solid, and the distance between entry and exit.
#pragma once
#include <array>
#include <limits>

#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// By channel, the number of scatterings after which a path is late: a renderer that limits the number of scatterings
/// loses its light.
using LateAfter = std::array<double, kChannels>;
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Sums over the samples from one point, per channel: w is the weight at the first exit, r the straight distance in mm
/// from start to exit. A sample's w, w r and w r^2 are means over its paths.
struct ExitSums {
  enum Score { kWeight, kDistance, kSquare, kScores };
  struct OfChannel {
    /// Sums of v = (w, w r, w r^2), and of the products v_i v_j, i <= j, by rows.
    std::array<double, kScores> moments = {};
    std::array<double, kScores*(kScores + 1) / 2> products = {};
    /// Sums of (w, w r) over the late paths, see LateAfter.
    std::array<double, kSquare> late = {};
  };
  std::array<OfChannel, kChannels> channels;

  void add(const ExitSums& other);
};

/// Records the first exit of each path.
class ExitTally final : public WalkListener {
 public:
  ExitTally(ExitSums& sums, const LateAfter& late_after) : sums_(sums), late_after_(late_after) {}

  void begin(const Place& start) { start_ = start; }
  bool leaves(const Meeting& exit) override;
  /// Ends a sample.
  void finish();

 private:
  ExitSums& sums_;
  LateAfter late_after_;
  Place start_;
  std::array<std::array<double, ExitSums::kScores>, kChannels> found_ = {};  ///< of the current sample, by channel
};

}  // namespace lamina
