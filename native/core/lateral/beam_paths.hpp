// SPDX-License-Identifier: GPL-3.0-or-later
// Light of a pencil beam that needs closed forms: light scattered once, rings of unscattered light, forward peaks.
#pragma once
#include <optional>
#include <vector>

#include "lateral/lateral_stack.hpp"
#include "lateral/lit_surface.hpp"
#include "lateral/oblique_scattering.hpp"
#include "lateral/once_scattered_beam.hpp"

namespace lamina {

/// Single scattering that is singular near a beam along the normal, for each face of a stack; see OnceScatteredBeam.
/// Empty where a rough boundary or a layer that does not scatter lies at that face. Keeps references into the stack.
std::optional<OnceScatteredBeam> once_scattered_upward(const LateralStack& stack);
std::optional<OnceScatteredBeam> once_scattered_downward(const LateralStack& stack);

/// Single scattering by media that are not next to the face where light leaves, see OnceScatteredBeam: one entry for
/// each scattering medium up to the first rough boundary. Empty for oblique beams and for more than four media. Keeps
/// references into the stack.
std::vector<OnceScatteredBeam> deeper_scattered_upward(const LateralStack& stack);
std::vector<OnceScatteredBeam> deeper_scattered_downward(const LateralStack& stack);

/// Light of the beam that the first rough boundary, or a Lambert or rough base, spreads towards a face, and that no
/// medium scatters, see LitSurface; also the light that smooth boundaries below a rough upper face send back. Empty for
/// oblique beams, without media on the way, and where another rough boundary lies on the way, except at the lower face.
std::vector<LitSurface> lit_surfaces(const LateralStack& stack, bool up);

/// Unscattered light of an oblique beam that leaves at a distance from the point of entry. The mean over azimuths is a
/// ring.
struct Ring {
  double radius;  ///< mm
  double flux;    ///< flux, including light of truncated peaks
  double direct;  ///< flux without light of truncated peaks
};
struct Rings {
  std::vector<Ring> reflected;
  std::vector<Ring> transmitted;
};

/// Single scattering of an oblique beam in the medium next to the top or the bottom, if only smooth boundaries lie
/// between.
std::optional<ObliqueScattering> oblique_scattering(const LateralStack& stack, bool top);

/// The rings of specular paths with at least 1e-9 of the beam's power. Empty for a beam along the normal.
Rings unscattered_rings(const LateralStack& stack);

/// The lateral spread of a beam along the normal by forward peaks, which truncation counts as unscattered: the spectrum
/// of their light, 1 at q = 0 and 0 in the limit. `legs` is 1 for light on the way down, 2 for light down and up again.
/// Small-angle approximation: light of a peak is scattered by peaks only, any number of times.
class ForwardPeaks {
 public:
  ForwardPeaks(const LateralStack& stack, int legs);
  bool none() const { return terms_.empty(); }
  double at(double q) const;

 private:
  struct Term {
    double weight;
    double distance;
  };
  std::vector<Term> terms_;
};

}  // namespace lamina
