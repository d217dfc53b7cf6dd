// SPDX-License-Identifier: GPL-3.0-or-later
// The interface of random walks that carry positions.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "numeric/rng.hpp"

namespace lamina {

/// Where the light of one sample leaves: above or below, at distances in mm from where the beam entered, with weights.
class Leaving {
 public:
  struct Exit {
    bool above = true;
    double r = 0.0;
    double weight = 0.0;
  };

  void add(bool above, double r, double weight) { exits_[count_++] = {above, r, weight}; }
  const Exit* begin() const { return exits_.data(); }
  const Exit* end() const { return exits_.data() + count_; }

 private:
  static constexpr std::size_t kMost = 4;  ///< scattered and not, above and below
  std::array<Exit, kMost> exits_;
  std::size_t count_ = 0;
};

/// A random walk of a pencil beam's light, which carries positions.
class LateralWalk {
 public:
  LateralWalk() = default;
  LateralWalk(const LateralWalk&) = delete;
  LateralWalk& operator=(const LateralWalk&) = delete;
  virtual ~LateralWalk() = default;

  /// One sample, at most two exits above and two below: the expected weight that leaves on a side within an area is
  /// the flux through it, for a beam of unit flux. Counts its scattering events. Called from many threads at once.
  virtual Leaving sample(Rng& rng, std::uint64_t& events) const = 0;

  double mirrored = 0.0;     ///< flux that leaves above without being scattered, which samples include
  double unscattered = 0.0;  ///< the same below
};

}  // namespace lamina
