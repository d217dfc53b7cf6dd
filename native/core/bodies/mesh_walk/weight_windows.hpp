// SPDX-License-Identifier: GPL-3.0-or-later
// Which weights photons should have in each part of a solid.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "interior/place.hpp"

namespace lamina {

class MeshWalk;
class PhotonSource;
class Solid;
class ThreadPool;

/// Weight windows for the light in all of a solid (Cooper and Larsen 2001, Nucl. Sci. Eng. 137; van Wijk et al. 2011,
/// Ann. Nucl. Energy 38). Photons that reach dark parts are split, so that many photons of small weight arrive there.
/// Two pilot runs of few photons find how dark each cell of a coarse grid is.
class WeightWindows {
 public:
  /// For photons of a source along a walk.
  WeightWindows(const MeshWalk& walk, const Solid& solid, const PhotonSource& source, ThreadPool& pool);

  /// The weight that photons at a position should have, at most 1.
  double target(const Place& place) const { return targets_.empty() ? 1.0 : targets_[cell(place)]; }

 private:
  std::vector<double> scattered(const MeshWalk& walk, const PhotonSource& source, std::uint64_t run,
                                ThreadPool& pool) const;
  std::vector<double> smooth(const std::vector<double>& light) const;
  void fill(std::vector<double>& light) const;
  std::size_t cell(const Place& place) const;
  template <typename Visit>
  void around(std::size_t cell, const Visit& visit) const;

  std::array<double, 3> low_;
  double side_;
  std::array<int, 3> count_;
  std::vector<double> targets_;  ///< by cell, x fastest
};

}  // namespace lamina
