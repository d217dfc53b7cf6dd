// SPDX-License-Identifier: GPL-3.0-or-later
// What a pencil beam leaves near itself: light scattered once, rings of unscattered light, forward peaks.
#pragma once
#include <optional>
#include <vector>

#include "lateral/lateral_stack.hpp"
#include "lateral/once_scattered_beam.hpp"

namespace lamina {

/// Light that a beam along the normal leaves singular near itself, for each face of a stack: see OnceScatteredBeam.
/// Empty where a rough boundary or a layer that does not scatter lies at that face. Keeps references into the stack.
std::optional<OnceScatteredBeam> once_scattered_upward(const LateralStack& stack);
std::optional<OnceScatteredBeam> once_scattered_downward(const LateralStack& stack);

/// Light that deeper media scatter once on its way to a face, see OnceScatteredBeam: all that scatter, up to the first
/// rough boundary, but the one next to the face. Empty for beams at a slant and for more than four media. Keeps
/// references into the stack.
std::vector<OnceScatteredBeam> deeper_scattered_upward(const LateralStack& stack);
std::vector<OnceScatteredBeam> deeper_scattered_downward(const LateralStack& stack);

/// Unscattered light of an oblique beam, which leaves beside the point of entry: a ring of this radius, in the mean
/// over azimuths.
struct Ring {
  double radius;  ///< mm
  double flux;    ///< truncated peaks count as unscattered
  double direct;  ///< without them
};
struct Rings {
  std::vector<Ring> reflected;
  std::vector<Ring> transmitted;
};
/// Followed through mirrors until less than 1e-9 of the beam is left. Empty along the normal.
Rings unscattered_rings(const LateralStack& stack);

/// How forward peaks, which truncation counts as unscattered, spread a beam along the normal: the spectrum of their
/// light, 1 at q = 0 and 0 in the limit, on the way down (`legs` 1) or down and up again (2). Small angles: a peak's
/// light is held to be scattered by peaks alone, any number of times.
class ForwardPeaks {
 public:
  ForwardPeaks(const LateralStack& stack, int legs);
  bool none() const { return whole_ < 1e-12; }
  double at(double q) const;

 private:
  struct Term {
    double weight;
    double distance;
  };
  std::vector<Term> terms_;
  double whole_ = 0.0;  ///< mean number of times that peaks scatter the beam
};

}  // namespace lamina
