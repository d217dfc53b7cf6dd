// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/photon_tally.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

namespace lamina {

namespace {

/// Adds up what each point has got, in the sequence of the deposits.
void merge(std::vector<Deposit>& found) {
  std::stable_sort(found.begin(), found.end(), [](const Deposit& a, const Deposit& b) { return a.point < b.point; });
  std::size_t merged = 0;
  for (const Deposit& one : found) {
    if (merged == 0 || found[merged - 1].point != one.point) {
      found[merged++] = one;
      continue;
    }
    Deposit& sum = found[merged - 1];
    for (std::size_t i = 0; i < sum.light.size(); ++i) {
      sum.light[i] += one.light[i];
      sum.square[i] += one.square[i];
    }
  }
  found.resize(merged);
}

}  // namespace

bool PhotonTally::leaves(const Meeting& exit) {
  // As along walks, light that passes a matched boundary without scattering does not count.
  if (boundary_.kind() == SurfaceBoundary::Kind::kMatched && exit.scatterings == 0) {
    return true;
  }
  if (const std::int32_t point = texels_.at(exit.face, exit.place); point != SurfaceTexels::kNone) {
    const double per_radiance = kChannels * std::numbers::pi * texels_.areas()[static_cast<std::size_t>(point)];
    Deposit deposit{point, {}, {}};
    add(deposit.light, exit.weights, 1.0 / per_radiance, exit.direction);
    sample_.push_back(deposit);
  }
  return true;
}

void PhotonTally::finish() {
  merge(sample_);
  for (Deposit& one : sample_) {
    for (std::size_t i = 0; i < one.light.size(); ++i) {
      one.square[i] = one.light[i] * one.light[i];
    }
  }
  samples_.insert(samples_.end(), sample_.begin(), sample_.end());
  sample_.clear();
}

std::vector<Deposit> PhotonTally::take() {
  merge(samples_);
  return std::move(samples_);
}

}  // namespace lamina
