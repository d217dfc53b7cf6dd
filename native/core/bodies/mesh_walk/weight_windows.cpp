// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/weight_windows.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "mesh_walk/photon_source.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

namespace {

constexpr int kCells = 24;                            // along the longest side
constexpr double kLeast = 1e-3;                       // least weight
constexpr int kRuns = 2;                              // of the pilot
constexpr std::uint64_t kPieces = 16;                 // of a run, whose sums are added in order
constexpr std::uint64_t kPhotons = 512;               // of a piece
constexpr std::uint64_t kSeed = 0x6a09e667f3bcc908U;  // a run with another seed has other random numbers

/// Sums the weights of photons where they scatter.
class ScatteringTally final : public WalkListener {
 public:
  ScatteringTally(std::size_t cells, std::function<std::size_t(const Place&)> cell)
      : light_(cells), cell_(std::move(cell)) {}
  bool leaves(const Meeting&) override { return true; }
  void scatters(const Scattering& scattering, Rng&) override {
    light_[cell_(scattering.place)] += mean_of(scattering.weights);
  }
  const std::vector<double>& light() const { return light_; }

 private:
  std::vector<double> light_;
  std::function<std::size_t(const Place&)> cell_;
};

}  // namespace

WeightWindows::WeightWindows(const MeshWalk& walk, const Solid& solid, const PhotonSource& source, ThreadPool& pool)
    : low_(solid.low()), side_(0.0) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    side_ = std::max(side_, (solid.high()[axis] - solid.low()[axis]) / kCells);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    count_[axis] = std::clamp(static_cast<int>(std::ceil((solid.high()[axis] - low_[axis]) / side_)), 1, kCells);
  }
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    const std::vector<double> found = scattered(walk, source, run, pool);
    const double sum = std::accumulate(found.begin(), found.end(), 0.0);
    if (!(sum > 0.0)) {
      return;
    }
    std::vector<double> light = smooth(found);
    // The mean light where photons scatter has the weight 1.
    double usual = 0.0;
    for (std::size_t k = 0; k < light.size(); ++k) {
      usual += light[k] * found[k] / sum;
    }
    fill(light);
    for (double& one : light) {
      one = std::clamp(one / usual, kLeast, 1.0);
    }
    targets_ = std::move(light);
  }
}

std::vector<double> WeightWindows::scattered(const MeshWalk& walk, const PhotonSource& source, std::uint64_t run,
                                             ThreadPool& pool) const {
  const std::size_t cells = static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1] * count_[2]);
  std::vector<std::vector<double>> pieces(kPieces);
  pool.run(kPieces, [&](std::size_t piece) {
    ScatteringTally tally(cells, [this](const Place& place) { return cell(place); });
    WalkCounts counts;
    for (std::uint64_t k = 0; k < kPhotons; ++k) {
      const std::uint64_t number = (run * kPieces + piece) * kPhotons + k;
      Rng rng(kSeed, number);
      if (const auto photon = source.photon(rng, counts)) {
        walk.shine(*photon, number % kChannels, rng, tally, counts, targets_.empty() ? nullptr : this);
      }
    }
    pieces[piece] = tally.light();
  });
  for (std::size_t piece = 1; piece < kPieces; ++piece) {
    for (std::size_t k = 0; k < cells; ++k) {
      pieces[0][k] += pieces[piece][k];
    }
  }
  return pieces[0];
}

/// Calls `visit` with each cell that touches a cell, itself included.
template <typename Visit>
void WeightWindows::around(std::size_t cell, const Visit& visit) const {
  const int index = static_cast<int>(cell);
  const std::array<int, 3> at{index % count_[0], index / count_[0] % count_[1], index / (count_[0] * count_[1])};
  for (int z = std::max(0, at[2] - 1); z <= std::min(count_[2] - 1, at[2] + 1); ++z) {
    for (int y = std::max(0, at[1] - 1); y <= std::min(count_[1] - 1, at[1] + 1); ++y) {
      for (int x = std::max(0, at[0] - 1); x <= std::min(count_[0] - 1, at[0] + 1); ++x) {
        visit(static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x));
      }
    }
  }
}

/// The mean of the lit cells about each one: less noise, and less dark at the surface, where cells are not full.
std::vector<double> WeightWindows::smooth(const std::vector<double>& light) const {
  std::vector<double> found(light.size());
  for (std::size_t k = 0; k < light.size(); ++k) {
    double sum = 0.0;
    int lit = 0;
    around(k, [&](std::size_t other) {
      sum += light[other];
      lit += static_cast<int>(light[other] > 0.0);
    });
    found[k] = lit > 0 ? sum / lit : 0.0;
  }
  return found;
}

/// Gives cells that no photon has reached half of the light of their brightest neighbour.
void WeightWindows::fill(std::vector<double>& light) const {
  for (bool changed = true; changed;) {
    changed = false;
    const std::vector<double> before = light;
    for (std::size_t k = 0; k < light.size(); ++k) {
      if (before[k] == 0.0) {
        around(k, [&](std::size_t other) { light[k] = std::max(light[k], 0.5 * before[other]); });
        changed = changed || light[k] > 0.0;
      }
    }
  }
}

std::size_t WeightWindows::cell(const Place& place) const {
  const std::array<double, 3> at{place.x, place.y, place.z};
  std::array<int, 3> index;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    index[axis] = std::clamp(static_cast<int>((at[axis] - low_[axis]) / side_), 0, count_[axis] - 1);
  }
  return static_cast<std::size_t>((index[2] * count_[1] + index[1]) * count_[0] + index[0]);
}

}  // namespace lamina
