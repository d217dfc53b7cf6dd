// SPDX-License-Identifier: GPL-3.0-or-later
// The directions, azimuths and frequency scale of a searchlight.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <variant>
#include <vector>

#include "lateral/searchlight.hpp"

namespace lamina {
namespace {

constexpr int kMostNodes = 40;
/// Light that a base or rough boundaries spread over a distance d is still seen at the frequency kSpot / d.
constexpr double kSpot = 30.0;

/// The least distance, in mm, over which lobes of rough boundaries and of a rough base spread light inside a stack of
/// this finite thickness; infinite without such light. Facets turn refracted light by less than they are tilted.
double spread_by_lobes(const Stack& stack, double thickness) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double slope = stack.base.is_rough() ? stack.base.facets.alpha : kInfinity;  // of the narrowest lobe
  double above = 1.0;
  for (const Layer& layer : stack.layers) {
    if (const auto* interface = std::get_if<Interface>(&layer)) {
      const double turned = interface->facets.alpha * std::min(1.0, std::abs(1.0 - above / interface->ior));
      slope = interface->is_rough(above) ? std::min(slope, turned) : slope;
      above = interface->ior;
    }
  }
  return thickness > 0.0 ? slope * thickness : kInfinity;
}

}  // namespace

/// Chooses directions for the sharpest phase function. Truncation keeps the moments below 2 * nodes, so the first
/// moments, which determine the mean distances, are exact.
void Searchlight::choose_resolution() {
  double peak = 0.0;
  bool bounded = false;
  for (const Layer& layer : measured_.stack.layers) {
    const auto* medium = std::get_if<Medium>(&layer);
    if (medium != nullptr && medium->albedo > 0.0 && medium->tau > 0.0) {
      peak = std::max(peak, medium->phase.peak());
    }
    const auto* interface = std::get_if<Interface>(&layer);
    bounded = bounded || (interface != nullptr && interface->ior != 1.0);
  }
  // Without attenuation, waves along a layer oscillate at all cosines. Measured with this number: errors of 1e-3.
  constexpr int kForClearLayers = 16;
  constexpr double kTruncated = 0.05;
  constexpr double kSmooth = 0.3;
  sharp_ = peak > kSmooth;
  const double wanted = peak > 0.0 ? 0.5 * std::log(kTruncated) / std::log(peak) : 0.0;
  resolution_.nodes = std::clamp(static_cast<int>(std::ceil(wanted)),
                                 bounded ? quality_.nodes_with_boundary : quality_.nodes, kMostNodes);
  if (runs_along_) {
    resolution_.nodes = std::max(resolution_.nodes, kForClearLayers);
  }
  resolution_.azimuths = quality_.azimuths;
  resolution_.bend = sharp_ ? std::clamp(0.1 - 0.5 * std::log(peak), 0.1, 0.6) : 0.6;
}

/// Chooses the frequency scale: `slowest`, where the spectra begin to fall, and `fastest`, beyond which only single
/// scattering and a tail are left.
void Searchlight::choose_scale() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double whole = 0.0;
  double finite = 0.0;
  double least = kInfinity;
  double slowest = kInfinity;
  double fastest = 0.0;
  for (std::size_t k = 0; k < measured_.stack.layers.size(); ++k) {
    const double thickness = std::holds_alternative<Medium>(measured_.stack.layers[k]) ? measured_.thickness[k] : 0.0;
    whole += thickness;
    finite += std::isinf(thickness) ? 0.0 : thickness;
  }
  for (std::size_t k = 0; k < measured_.stack.layers.size(); ++k) {
    const auto* medium = std::get_if<Medium>(&measured_.stack.layers[k]);
    if (medium == nullptr || !(measured_.thickness[k] > 0.0)) {
      continue;
    }
    const double thickness = measured_.thickness[k];
    if (medium->albedo > 0.0 && medium->tau > 0.0) {
      const TruncatedMedium truncated(*medium, resolution_.moments());
      const double extinction = measured_.extinction[k] * (1.0 - medium->albedo * truncated.forward_share);
      const double reduced = 1.0 - truncated.albedo * truncated.moments[1];
      const double absorbed = std::sqrt(3.0 * (1.0 - truncated.albedo) * reduced);
      const double leak = 1.0 / (extinction * whole + 1.0 / reduced);
      slowest = std::min(slowest, extinction * std::min(1.0, std::hypot(absorbed, leak)));
      least = std::min(least, extinction);
      fastest = std::max({fastest, 20.0 * extinction, 6.0 / thickness});
    } else {
      const double extinction = measured_.extinction[k];
      slowest = std::min(slowest, std::isinf(thickness) ? extinction : std::hypot(extinction, 1.0 / thickness));
      fastest = std::max(fastest, std::isinf(thickness) ? extinction : 10.0 / thickness);
    }
  }
  const Base& base = measured_.stack.base;
  if (base.is_diffuse() && whole > 0.0 && !std::isinf(whole)) {
    // The spot that the beam lights on the base, and the edge of its total reflection.
    fastest = std::max(fastest, kSpot / whole);
  }
  fastest = std::max(fastest, kSpot / spread_by_lobes(measured_.stack, finite));
  if (!(fastest > 0.0) || std::isinf(slowest)) {
    slowest = 1.0;
    fastest = 2.0;
  }
  constexpr double kSlowest = 0.03;
  constexpr double kLow = 1.5;  // relative to the extinction
  extinction_ = std::isinf(least) ? slowest : least;
  decay_ = slowest > 0.0 ? slowest : 1e-3 * extinction_;
  scale_ = {std::max(slowest, kSlowest * extinction_)};
  const double middle = scale_.place(std::min(std::max(kLow * extinction_, 2.0 * scale_.slowest), 0.5 * fastest));
  pieces_[0] = {0.0, middle, 0, {}};
  pieces_[1] = {middle, scale_.place(fastest), 0, {}};
}

AzimuthRule Searchlight::azimuths_for(double q) const {
  if (q == 0.0) {
    return AzimuthRule::mean();
  }
  struct Zone {
    double wave;
    Eigen::Index azimuths;
    double bend;
  };
  // A bent path damps the waves, but mixes high azimuth orders with the mean, which scattering amplifies in thick
  // layers. Slow waves need no bend. Measured errors with these numbers: 1e-9 at low and 1e-6 at high frequencies,
  // relative to the flux of a half-space.
  constexpr std::array<Zone, 3> kZones{{{0.1, 6, 0.1}, {0.4, 8, 0.2}, {1.2, 10, 0.3}}};
  const double wave = q / extinction_;
  const auto zone = std::find_if(kZones.begin(), kZones.end(), [&](const Zone& one) { return wave < one.wave; });
  const bool fast = zone == kZones.end();
  const Eigen::Index least = fast ? 12 : zone->azimuths;
  const double bend = fast ? resolution_.bend : std::min(zone->bend, resolution_.bend);
  const Eigen::Index count = std::min(sharp_ ? least : std::min<Eigen::Index>(least, 8), resolution_.azimuths);
  return AzimuthRule(count, bend, count);
}

/// The share of the second beam in the spectrum at q: 0 at low and 1 at high frequencies.
double Searchlight::forward_share(double q) const {
  if (q <= forward_from_) {
    return 0.0;
  }
  const double x = std::min(1.0, std::log(q / forward_from_) / std::log(forward_only_ / forward_from_));
  return x * x * (3.0 - 2.0 * x);
}

/// Compares fluxes with those of more nodes, at q = 0 and where light is scattered about once per wavelength. If they
/// differ, replaces the beam by one with more nodes and returns true.
bool Searchlight::refine(ThreadPool& pool) {
  constexpr int kMore = 4;
  LateralResolution finer = resolution_;
  finer.nodes += kMore;
  auto other = std::make_unique<ResolvedBeam>(measured_, finer, mu_, pool);
  std::array<LateralFlux, 4> fluxes;
  const double q = scale_.slowest;
  pool.run(fluxes.size(), [&](std::size_t k) {
    const bool fine = k >= 2;
    const double frequency = k % 2 == 0 ? 0.0 : q;
    fluxes[k] = (fine ? *other : *beam_).stack().at(frequency, azimuths_for(frequency));
  });
  double change = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto differ = [&](double a, double b) { change = std::max(change, std::abs(a - b)); };
    differ(fluxes[k].reflected, fluxes[k + 2].reflected);
    differ(fluxes[k].transmitted, fluxes[k + 2].transmitted);
  }
  if (change <= quality_.resolution) {
    return false;
  }
  if (resolution_.nodes >= kMostNodes) {
    std::ostringstream message;
    message << "the stack cannot be resolved: at " << resolution_.nodes
            << " nodes per hemisphere the flux still changes by " << change << " (allowed " << quality_.resolution
            << ")";
    throw std::runtime_error(message.str());
  }
  resolution_.nodes = std::min(kMostNodes, finer.nodes);
  if (resolution_.nodes < finer.nodes) {
    other = std::make_unique<ResolvedBeam>(measured_, resolution_, mu_, pool);
  }
  beam_ = std::move(other);
  return true;
}

/// Chooses denser directions for high frequencies. After a length z, light of adjacent directions is apart by z times
/// the difference d of their slopes. A discretised spectrum of light that has been scattered near the beam, by a
/// forward peak, a base or a half-space, is wrong where q z d is above about 1. At these frequencies peaks need denser
/// directions near the beam only; a base and a half-space need them everywhere.
void Searchlight::resolve_forward(ThreadPool& pool) {
  double way = 0.0;
  double tau = 0.0;
  bool endless = false;
  for (const std::optional<LateralMedium>& medium : beam_->stack().media()) {
    if (medium && std::isinf(medium->thickness())) {
      endless = true;
    } else if (medium) {
      way += medium->thickness();
      tau += medium->medium().tau;
    }
  }
  const Base& base = measured_.stack.base;
  const bool by_peaks = sharp_ && !endless && base.kind == Base::Kind::kNone;
  constexpr double kOpaque = 8.0;  // little of the beam passes unscattered to a base or a half-space
  const bool from_below = (endless || base.is_diffuse()) && tau < kOpaque;
  if (quality_.forward == 0 || !(by_peaks || from_below) || way == 0.0 || !beam_->stack().along_normal()) {
    return;
  }
  const Directions& directions = beam_->stack().directions().back();
  std::vector<double> cosines(directions.mu.begin(), directions.mu.begin() + directions.live);
  std::partial_sort(cosines.begin(), cosines.begin() + 2, cosines.end(), std::greater<>());
  const auto slope = [](double mu) { return std::sqrt(1.0 - mu * mu) / mu; };
  constexpr double kBegin = 1.0;
  constexpr double kBeginBelow = 0.3;
  constexpr double kEnd = 3.0;  // relative to the beginning
  const double apart = way * (slope(cosines[1]) - slope(cosines[0]));
  forward_from_ = (by_peaks ? kBegin : kBeginBelow) / apart;
  forward_only_ = kEnd * forward_from_;
  if (forward_from_ >= scale_.frequency(pieces_[1].high)) {
    return;
  }
  LateralResolution forward = resolution_;
  if (by_peaks) {
    forward.nodes = forward.forward = quality_.forward;
  } else {
    forward.nodes = std::min(kMostNodes, 2 * resolution_.nodes);
  }
  forward_ = std::make_unique<ResolvedBeam>(measured_, forward, mu_, pool);
  constexpr Eigen::Index kMostDirections = 64;  // more would take minutes
  if (!by_peaks && forward_->stack().directions().front().nodes > kMostDirections) {
    forward_.reset();
    return;
  }
  // Leave the directions as they are if the spectra agree, relative to the beam.
  constexpr double kAgree = 3e-3;
  constexpr double kAgreeBelow = 3e-4;
  const std::array<double, 3> tried{forward_only_, 2.0 * forward_only_, 4.0 * forward_only_};
  std::array<double, 3> differences{};
  pool.run(tried.size(), [&](std::size_t k) {
    const AzimuthRule azimuths = azimuths_for(tried[k]);
    const std::size_t face = by_peaks ? 1 : 0;
    differences[k] = std::abs(beam_->beside(tried[k], azimuths)[face] - forward_->beside(tried[k], azimuths)[face]);
  });
  if (*std::max_element(differences.begin(), differences.end()) < (by_peaks ? kAgree : kAgreeBelow)) {
    forward_.reset();
  }
}

}  // namespace lamina
