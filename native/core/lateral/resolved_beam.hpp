// SPDX-License-Identifier: GPL-3.0-or-later
// A stack at one resolution of directions, with the light of a beam that needs closed forms.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "lateral/beam_paths.hpp"
#include "lateral/lateral_stack.hpp"
#include "lateral/lit_surface.hpp"
#include "lateral/once_scattered_beam.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// The spectrum of a beam's light on directions of one resolution. Single scattering and other light that stays
/// concentrated near the beam are corrected by their closed forms. Other members refer to the stack, so objects cannot
/// be copied.
class ResolvedBeam {
 public:
  using Faces = std::array<double, 2>;  ///< the upper and the lower face

  ResolvedBeam(const MeasuredStack& measured, const LateralResolution& resolution, double mu, ThreadPool& pool);
  ResolvedBeam(const ResolvedBeam&) = delete;
  ResolvedBeam& operator=(const ResolvedBeam&) = delete;

  const LateralStack& stack() const { return stack_; }
  /// The limit of high frequencies: light that leaves at the point of entry.
  const LateralFlux& limit() const { return limit_; }
  /// Single scattering that is singular near the beam.
  const std::optional<OnceScatteredBeam>& once(std::size_t face) const { return once_[face]; }

  /// Single scattering of an oblique beam next to a face; `beside` is without it.
  const std::optional<ObliqueScattering>& oblique(std::size_t face) const { return oblique_[face]; }

  /// The spectrum of light that leaves beside the point of entry, at the lateral frequency q, 1/mm. Light in rings is
  /// left out. Thread-safe.
  Faces beside(double q, const AzimuthRule& azimuths) const;

 private:
  LateralStack stack_;
  LateralFlux limit_;
  std::array<std::optional<OnceScatteredBeam>, 2> once_;
  std::array<std::optional<ObliqueScattering>, 2> oblique_;
  std::array<std::vector<OnceScatteredBeam>, 2> deeper_;
  std::array<std::vector<LitSurface>, 2> lit_;
  std::array<std::optional<ForwardPeaks>, 2> peaks_;  // of reflected and of transmitted light
};

}  // namespace lamina
