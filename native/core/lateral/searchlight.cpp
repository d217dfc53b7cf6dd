// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/searchlight.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "numeric/bessel.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

// Of a piece, for a beam along the normal, and for an oblique beam. Light of an oblique beam leaves far from the point
// of entry, and its spectrum oscillates.
constexpr int kMostIntervals = 64;
constexpr int kMostIntervalsOblique = 512;
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

/// True if a layer of finite thickness does not scatter. Light that travels along such a layer gives the spectra nearly
/// logarithmic singularities close to frequency 0.
bool has_layer_without_scattering(const MeasuredStack& measured) {
  for (std::size_t k = 0; k < measured.stack.layers.size(); ++k) {
    const auto* medium = std::get_if<Medium>(&measured.stack.layers[k]);
    const double thickness = measured.thickness[k];
    if (medium != nullptr && medium->albedo * medium->tau == 0.0 && thickness > 0.0 && !std::isinf(thickness)) {
      return true;
    }
  }
  return false;
}

/// True if light can travel along a layer without attenuation.
bool has_clear_layer(const MeasuredStack& measured) {
  bool scatters = measured.stack.base.scatters();
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
  return clear && scatters;
}

}  // namespace

double LeavingLight::at(double q) const {
  double sum = at_entry + rest.at(q) + (once ? once->whole_at(q) : 0.0) + (oblique ? oblique->at(q) : 0.0);
  for (const Ring& ring : rings) {
    sum += ring.flux * bessel_j0(q * ring.radius);
  }
  return sum;
}

double LeavingLight::inside(double r) const {
  double sum = at_entry + rest.inside(r) + (once ? once->inside(r) : 0.0) + (oblique ? oblique->inside(r) : 0.0);
  for (const Ring& ring : rings) {
    sum += ring.radius <= r ? ring.flux : 0.0;
  }
  return sum;
}

double LeavingLight::density(double r) const {
  return rest.density(r) + (once ? once->density_times_radius(r) / r : 0.0) + (oblique ? oblique->density(r) : 0.0);
}

Searchlight::Searchlight(MeasuredStack measured, double mu, const SearchlightQuality& quality)
    : measured_(std::move(measured)), mu_(mu), quality_(quality) {
  spreads_ = is_endless_and_bright(measured_);
  runs_along_ = has_clear_layer(measured_);
  choose_resolution();
  choose_scale();
  // If all layers scatter, the spectrum is a power series in q^2 with the radius decay^2, which allows large steps.
  // Smaller steps amplify the solver's errors: the mean square is a quotient by the square of the first step.
  constexpr int kSmall = 6;
  const double step = has_layer_without_scattering(measured_) ? 0.02 : 0.15;
  for (int k = 1; k <= kSmall; ++k) {
    small_.push_back(step * k * decay_);
  }
}

/// The spectrum at q without light at r = 0, rings, and the closed form of single scattering.
Searchlight::Faces Searchlight::rest_at(double q) const {
  const AzimuthRule azimuths = azimuths_for(q);
  const double share = forward_ ? forward_share(q) : 0.0;
  Faces rest{};
  for (const auto& [beam, weight] : {std::pair{beam_.get(), 1.0 - share}, std::pair{forward_.get(), share}}) {
    if (weight > 0.0) {
      const Faces beside = beam->beside(q, azimuths);
      for (std::size_t face = 0; face < rest.size(); ++face) {
        rest[face] += weight * beside[face];
      }
    }
  }
  for (std::size_t face = 0; face < rest.size(); ++face) {
    if (const std::optional<OnceScatteredBeam>& once = faces_[face].once) {
      rest[face] -= once->whole_at(q);
    }
  }
  return rest;
}

void Searchlight::advance(ThreadPool& pool) {
  if (done_) {
    return;
  }
  if (!beam_) {
    beam_ = std::make_unique<ResolvedBeam>(measured_, resolution_, mu_, pool);
    while (refine(pool)) {
    }
    resolve_forward(pool);
    for (std::size_t face = 0; face < faces_.size(); ++face) {
      faces_[face].once = beam_->once(face);
      if (beam_->oblique(face)) {
        faces_[face].oblique = beam_->oblique(face)->by_distance();
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
    const int most = mu_ == 1.0 ? kMostIntervals : kMostIntervalsOblique;
    if (!is_resolved(number) && pieces_[number].intervals < most) {
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
    faces_[face].rest = Spectrum(scale_, std::move(spectrum), !faces_[face].once && !faces_[face].oblique);
  }
  const Rings rings = unscattered_rings(beam_->stack());
  faces_[0].rings = rings.reflected;
  faces_[1].rings = rings.transmitted;
  faces_[0].at_entry = beam_->limit().reflected;
  faces_[1].at_entry = beam_->limit().transmitted;
  faces_[0].direct = beam_->limit().mirrored;
  faces_[1].direct = beam_->limit().unscattered;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    LeavingLight& light = faces_[face];
    for (const Ring& ring : light.rings) {
      light.direct += ring.direct;
    }
    light.flux = light.at(0.0);
    add_moments(face);
    // The mean distances may be infinite.
    if (!std::isfinite(light.flux) || std::isnan(light.distance) || std::isnan(light.square_distance)) {
      throw std::runtime_error("the stack cannot be resolved: a result is not a number");
    }
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
  light.distance = mean + (light.once ? light.once->moment(1) : 0.0) + (light.oblique ? light.oblique->moment(1) : 0.0);
  light.square_distance = 4.0 * quotient(0.0) + (light.once ? light.once->moment(2) : 0.0) +
                          (light.oblique ? light.oblique->moment(2) : 0.0);
  for (const Ring& ring : light.rings) {
    light.distance += ring.flux * ring.radius;
    light.square_distance += ring.flux * ring.radius * ring.radius;
  }
  if (runs_along_) {
    light.square_distance = std::numeric_limits<double>::infinity();
  }
}

}  // namespace lamina
