// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/searchlight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

constexpr int kMostNodes = 40;
constexpr int kMostIntervals = 64;
constexpr std::size_t kBatch = 8;

bool is_endless_and_bright(const MeasuredStack& measured) {
  const std::vector<Layer>& layers = measured.stack.layers;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const auto* medium = std::get_if<Medium>(&layers[k]);
    if (medium != nullptr && std::isinf(measured.thickness[k]) && medium->albedo == 1.0) {
      return true;
    }
  }
  return false;
}

/// True if light can travel along a layer without attenuation.
bool has_clear_layer(const MeasuredStack& measured) {
  bool scatters = measured.stack.base.kind == Base::Kind::kLambert && measured.stack.base.reflectance > 0.0;
  bool clear = false;
  for (std::size_t k = 0; k < measured.stack.layers.size(); ++k) {
    const Layer& layer = measured.stack.layers[k];
    if (const auto* medium = std::get_if<Medium>(&layer)) {
      scatters = scatters || medium->albedo * medium->tau > 0.0;
      clear = clear || (medium->tau == 0.0 && measured.thickness[k] > 0.0);
    } else if (const auto* interface = std::get_if<Interface>(&layer)) {
      scatters = scatters || interface->facets.alpha > 0.0;
    }
  }
  scatters = scatters || (measured.stack.base.kind == Base::Kind::kConductor && measured.stack.base.facets.alpha > 0.0);
  return clear && scatters;
}

}  // namespace

double LeavingLight::at(double q) const {
  double sum = at_entry + rest.at(q) + (once ? once->whole_at(q) : 0.0);
  for (const Ring& ring : rings) {
    sum += ring.flux * j0(q * ring.radius);
  }
  return sum;
}

double LeavingLight::inside(double r) const {
  double sum = at_entry + rest.inside(r) + (once ? once->inside(r) : 0.0);
  for (const Ring& ring : rings) {
    sum += ring.radius <= r ? ring.flux : 0.0;
  }
  return sum;
}

double LeavingLight::density(double r) const {
  return rest.density(r) + (once ? once->density_times_radius(r) / r : 0.0);
}

Searchlight::Searchlight(MeasuredStack measured, double mu, const SearchlightQuality& quality)
    : measured_(std::move(measured)), mu_(mu), quality_(quality) {
  spreads_ = is_endless_and_bright(measured_);
  runs_along_ = has_clear_layer(measured_);
  choose_resolution();
  choose_scale();
  constexpr int kSmall = 5;
  for (int k = 1; k <= kSmall; ++k) {
    small_.push_back(0.02 * k * decay_);
  }
}

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
  double least = kInfinity;
  double slowest = kInfinity;
  double fastest = 0.0;
  for (std::size_t k = 0; k < measured_.stack.layers.size(); ++k) {
    whole += std::holds_alternative<Medium>(measured_.stack.layers[k]) ? measured_.thickness[k] : 0.0;
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
  // Measured errors with these numbers, relative to the flux of a half-space: 1e-8 at low and 1e-6 at high frequencies.
  const double wave = q / extinction_;
  const Eigen::Index least = wave < 0.1 ? 6 : wave < 0.4 ? 8 : wave < 1.2 ? 10 : 12;
  const Eigen::Index count = std::min(sharp_ ? least : std::min<Eigen::Index>(least, 8), resolution_.azimuths);
  return AzimuthRule(count, resolution_.bend, count);
}

/// The spectrum at q without light at r = 0, rings, and the closed form of single scattering.
Searchlight::Faces Searchlight::rest_at(double q) const {
  const AzimuthRule azimuths = azimuths_for(q);
  const LateralFlux flux = stack_->at(q, azimuths);
  Faces rest{};
  const auto scattered = [&](double all, double direct, double limit, const std::optional<ForwardPeaks>& peaks) {
    // For a beam along the normal, light of truncated peaks spreads; for an oblique beam it stays in the rings.
    const double spread = peaks ? (direct - limit) * peaks->at(q) : 0.0;
    return all - direct + spread;
  };
  rest[0] =
      scattered(flux.reflected, flux.mirrored, limit_.mirrored, peaks_back_) - (limit_.reflected - limit_.mirrored);
  rest[1] = scattered(flux.transmitted, flux.unscattered, limit_.unscattered, peaks_down_) -
            (limit_.transmitted - limit_.unscattered);
  for (std::size_t face = 0; face < rest.size(); ++face) {
    if (const std::optional<OnceScatteredBeam>& once = faces_[face].once) {
      rest[face] += once->at(q) - once->discretised(q, azimuths) - once->whole_at(q);
    }
    for (const OnceScatteredBeam& deeper : deeper_[face]) {
      rest[face] += deeper.at(q) - deeper.discretised(q, azimuths);
    }
  }
  return rest;
}

void Searchlight::prepare(ThreadPool& pool) {
  stack_ = std::make_unique<LateralStack>(measured_, resolution_, mu_, pool);
  limit_ = stack_->at_infinity();
}

/// Compares fluxes with those of more nodes, at q = 0 and where light is scattered about once per wavelength. If they
/// differ, adds nodes and returns true.
bool Searchlight::refine(ThreadPool& pool) {
  constexpr int kMore = 4;
  LateralResolution finer = resolution_;
  finer.nodes += kMore;
  const LateralStack other(measured_, finer, mu_, pool);
  std::array<LateralFlux, 4> fluxes;
  const double q = scale_.slowest;
  pool.run(fluxes.size(), [&](std::size_t k) {
    const bool fine = k >= 2;
    const double frequency = k % 2 == 0 ? 0.0 : q;
    fluxes[k] = (fine ? other : *stack_).at(frequency, azimuths_for(frequency));
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
  resolution_.nodes = std::min(kMostNodes, resolution_.nodes + kMore);
  return true;
}

void Searchlight::advance(ThreadPool& pool) {
  if (done_) {
    return;
  }
  if (!stack_) {
    do {
      prepare(pool);
    } while (refine(pool));
    faces_[0].once = once_scattered_upward(*stack_);
    faces_[1].once = once_scattered_downward(*stack_);
    deeper_ = {deeper_scattered_upward(*stack_), deeper_scattered_downward(*stack_)};
    if (stack_->along_normal()) {
      peaks_down_.emplace(*stack_, 1);
      peaks_back_.emplace(*stack_, 2);
      for (auto* peaks : {&peaks_down_, &peaks_back_}) {
        if ((*peaks)->none()) {
          peaks->reset();
        }
      }
    }
    for (auto& rest : small_rest_) {
      rest.resize(small_.size());
    }
    for (std::size_t number = 0; number < pieces_.size(); ++number) {
      refine_piece(number);
    }
    progress_ = 0.1;
    return;
  }
  const std::size_t count = std::min(kBatch, waiting_.size());
  const std::size_t extra = small_solved_ ? 0 : small_.size();
  small_solved_ = true;
  pool.run(count + extra, [&](std::size_t task) {
    const Wanted wanted = task < count ? waiting_[task] : Wanted{0, 0};
    Piece& piece = pieces_[wanted.piece];
    const double q = task < count ? piece.frequency(scale_, wanted.node) : small_[task - count];
    const Faces rest = rest_at(q);
    for (std::size_t face = 0; face < rest.size(); ++face) {
      if (task < count) {
        piece.rest[face][static_cast<std::size_t>(wanted.node)] = rest[face];
      } else {
        small_rest_[face][task - count] = rest[face];
      }
    }
  });
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
  progress_ += (0.95 - progress_) * static_cast<double>(count) / static_cast<double>(count + waiting_.size() + 16);
  if (!waiting_.empty()) {
    return;
  }
  for (std::size_t number = 0; number < pieces_.size(); ++number) {
    if (!is_resolved(number) && pieces_[number].intervals < kMostIntervals) {
      refine_piece(number);
    }
  }
  if (waiting_.empty()) {
    finish();
  }
}

/// Doubles the number of frequencies of a piece; half of them are known.
void Searchlight::refine_piece(std::size_t number) {
  Piece& piece = pieces_[number];
  const bool first = piece.intervals == 0;
  piece.intervals = first ? quality_.intervals : 2 * piece.intervals;
  for (std::vector<double>& values : piece.rest) {
    std::vector<double> finer(static_cast<std::size_t>(piece.intervals) + 1, 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) {
      finer[2 * k] = values[k];
    }
    values = std::move(finer);
  }
  for (int k = 0; k <= piece.intervals; ++k) {
    if (first || k % 2 == 1) {
      waiting_.push_back({number, k});
    }
  }
}

bool Searchlight::is_resolved(std::size_t number) const {
  constexpr double kFaint = 1e-2;  // share of the beam: errors of smaller spectra are relative to this
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    double largest = kFaint;
    for (const double value : pieces_[0].rest[face]) {
      largest = std::max(largest, std::abs(value));
    }
    const SpectrumPiece piece{pieces_[number].low, pieces_[number].high, pieces_[number].rest[face]};
    if (piece.roughness() > quality_.interpolation[number] * largest) {
      return false;
    }
  }
  return true;
}

std::size_t Searchlight::frequencies() const {
  return pieces_[0].rest[0].size() + pieces_[1].rest[0].size() + small_.size();
}

void Searchlight::finish() {
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    std::vector<SpectrumPiece> spectrum;
    for (const Piece& piece : pieces_) {
      spectrum.push_back({piece.low, piece.high, piece.rest[face]});
    }
    faces_[face].rest = Spectrum(scale_, std::move(spectrum), !faces_[face].once);
  }
  const Rings rings = unscattered_rings(*stack_);
  faces_[0].rings = rings.reflected;
  faces_[1].rings = rings.transmitted;
  faces_[0].at_entry = limit_.reflected;
  faces_[1].at_entry = limit_.transmitted;
  faces_[0].direct = limit_.mirrored;
  faces_[1].direct = limit_.unscattered;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    LeavingLight& light = faces_[face];
    for (const Ring& ring : light.rings) {
      light.direct += ring.direct;
    }
    light.flux = light.at(0.0);
    add_moments(face);
  }
  done_ = true;
  progress_ = 1.0;
}

/// The mean of r is int (F(0) - F(q)) / q^2 dq, and the mean of r^2 is 4 (F(0) - F(q)) / q^2 at q = 0. Near 0 the
/// quotient is a polynomial in q^2.
void Searchlight::add_moments(std::size_t face) {
  LeavingLight& light = faces_[face];
  const bool none = face == 1 && measured_.stack.base.kind != Base::Kind::kNone;
  if (none) {
    return;
  }
  if (spreads_) {
    light.distance = light.square_distance = std::numeric_limits<double>::infinity();
    return;
  }
  const double whole = pieces_[0].rest[face].front();
  const auto quotient = [&](double q) {
    const double x = q * q;
    double sum = 0.0;
    for (std::size_t k = 0; k < small_.size(); ++k) {
      const double own = small_[k] * small_[k];
      double weight = 1.0;
      for (const double other : small_) {
        weight *= other == small_[k] ? 1.0 : (x - other * other) / (own - other * other);
      }
      sum += weight * (whole - small_rest_[face][k]) / own;
    }
    return sum;
  };
  static const Quadrature rule(12);
  const double first = small_.back();
  double mean = 0.0;
  for (Eigen::Index i = 0; i < rule.mu.size(); ++i) {
    mean += first * rule.weight[i] * quotient(first * rule.mu[i]);
  }
  constexpr double kPiece = 0.5;
  const double begin = scale_.place(first);
  const double end = pieces_[1].high + 12.0;
  const int pieces = static_cast<int>(std::ceil((end - begin) / kPiece));
  for (int k = 0; k < pieces; ++k) {
    const double low = scale_.frequency(begin + (end - begin) * k / pieces);
    const double high = scale_.frequency(begin + (end - begin) * (k + 1) / pieces);
    for (Eigen::Index i = 0; i < rule.mu.size(); ++i) {
      const double q = low + (high - low) * rule.mu[i];
      mean += (high - low) * rule.weight[i] * (whole - light.rest.at(q)) / (q * q);
    }
  }
  mean += whole / scale_.frequency(end);
  light.distance = mean + (light.once ? light.once->moment(1) : 0.0);
  light.square_distance = 4.0 * quotient(0.0) + (light.once ? light.once->moment(2) : 0.0);
  for (const Ring& ring : light.rings) {
    light.distance += ring.flux * ring.radius;
    light.square_distance += ring.flux * ring.radius * ring.radius;
  }
  if (runs_along_) {
    light.square_distance = std::numeric_limits<double>::infinity();
  }
}

}  // namespace lamina
