// SPDX-License-Identifier: GPL-3.0-or-later
// The interface of random walks that carry positions.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "numeric/rng.hpp"

namespace lamina {

/// Exits of one sample: the side, the distance in mm from the point where the beam entered, and the weight.
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
  static constexpr std::size_t kMost = 4;  ///< a scattered and an unscattered exit on each side
  std::array<Exit, kMost> exits_;
  std::size_t count_ = 0;
};

/// A random walk of a pencil beam's light with positions.
class LateralWalk {
 public:
  LateralWalk() = default;
  LateralWalk(const LateralWalk&) = delete;
  LateralWalk& operator=(const LateralWalk&) = delete;
  virtual ~LateralWalk() = default;

  /// Draws one sample, with at most two exits above and two below. The expected weight that leaves through an area of a
  /// side is the flux through this area, for a beam of unit flux. Adds the number of scattering events to `events`.
  /// Thread-safe.
  virtual Leaving sample(Rng& rng, std::uint64_t& events) const = 0;

  double mirrored = 0.0;     ///< unscattered flux that leaves above; samples include it
  double unscattered = 0.0;  ///< unscattered flux that leaves below; samples include it
};

}  // namespace lamina
