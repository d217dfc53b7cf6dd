// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/resolved_beam.hpp"

namespace lamina {

ResolvedBeam::ResolvedBeam(const MeasuredStack& measured, const LateralResolution& resolution, double mu,
                           ThreadPool& pool)
    : stack_(measured, resolution, mu, pool),
      limit_(stack_.at_infinity()),
      once_{once_scattered_upward(stack_), once_scattered_downward(stack_)},
      oblique_{oblique_scattering(stack_, true), oblique_scattering(stack_, false)},
      deeper_{deeper_scattered_upward(stack_), deeper_scattered_downward(stack_)},
      lit_{lit_surfaces(stack_, true), lit_surfaces(stack_, false)} {
  // The closed forms replace light at the nodes themselves.
  if (deeper_[0].empty() && deeper_[1].empty() && lit_[0].empty() && lit_[1].empty()) {
    stack_.resolve_passing();
  }
  if (!stack_.along_normal()) {
    return;
  }
  for (const int legs : {1, 2}) {
    ForwardPeaks peaks(stack_, legs);
    if (!peaks.none()) {
      peaks_[legs == 1 ? 1 : 0] = std::move(peaks);
    }
  }
}

ResolvedBeam::Faces ResolvedBeam::beside(double q, const AzimuthRule& azimuths) const {
  const LateralFlux flux = stack_.at(q, azimuths);
  const auto scattered = [&](double all, double direct, double limit, const std::optional<ForwardPeaks>& peaks) {
    // For a beam along the normal, light of truncated peaks spreads; for an oblique beam it stays in the rings.
    const double spread = peaks ? (direct - limit) * peaks->at(q) : 0.0;
    return all - direct + spread;
  };
  Faces rest{
      scattered(flux.reflected, flux.mirrored, limit_.mirrored, peaks_[0]) - (limit_.reflected - limit_.mirrored),
      scattered(flux.transmitted, flux.unscattered, limit_.unscattered, peaks_[1]) -
          (limit_.transmitted - limit_.unscattered)};
  for (std::size_t face = 0; face < rest.size(); ++face) {
    if (once_[face]) {
      rest[face] += once_[face]->at(q) - once_[face]->discretised(q, azimuths);
    }
    if (oblique_[face]) {
      rest[face] -= oblique_[face]->discretised(q, azimuths);
    }
    for (const OnceScatteredBeam& deeper : deeper_[face]) {
      rest[face] += deeper.at(q) - deeper.discretised(q, azimuths);
    }
    for (const LitSurface& lit : lit_[face]) {
      rest[face] += lit.at(q) - lit.discretised(q, azimuths);
    }
  }
  return rest;
}

}  // namespace lamina
