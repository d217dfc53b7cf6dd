// SPDX-License-Identifier: GPL-3.0-or-later
// Flux as a table over the distance from the point of entry.
#pragma once
#include <cstddef>
#include <vector>

namespace lamina {

/// Flux by distance, spread evenly over the distances of each bin. Distances in mm.
class FluxByDistance {
 public:
  /// No flux yet. Bins are narrowest at distance 0, and grow beyond `scale`.
  FluxByDistance(double scale, double farthest);

  /// Adds flux, spread evenly from the distance `low` to `high`.
  void add(double low, double high, double flux);
  /// Multiplies all flux, so that the total is `flux`. Call this after all flux is added, before any other function.
  void normalise(double flux);

  /// The integral of the flux density times J0(q r).
  double at(double q) const;
  double inside(double r) const;
  /// Flux density, 1/mm^2: a mean over distances that differ by a few percent.
  double density(double r) const;
  /// The mean of r^power, 1 or 2, times the total flux.
  double moment(int power) const;

 private:
  std::size_t bin_of(double r) const;

  double scale_;
  double step_;
  std::vector<double> edges_;
  std::vector<double> flux_;    // by bin
  std::vector<double> within_;  // by edge
};

}  // namespace lamina
