// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/film.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

constexpr double kExact = 1e-12;

/// The transfer matrix of all films for one polarisation, without a factor exp(growth), which might overflow.
struct Transfer {
  Complex m11 = 1.0;
  Complex m12 = 0.0;
  Complex m21 = 0.0;
  Complex m22 = 1.0;
  double growth = 0.0;

  /// Adds a film below. `square`: 1, or for light polarised in the plane of incidence the square of the index.
  void add(Complex along, Complex square, double thickness) {
    const Complex phase = 2.0 * pi * thickness * along;
    const double rise = phase.imag();
    const Complex down = std::exp(Complex(-2.0 * rise, 2.0 * phase.real()));  // exp(2 i phase)
    const Complex turn = std::exp(Complex(0.0, -phase.real()));
    const Complex cosine = 0.5 * turn * (1.0 + down);
    const Complex wave = 0.5 * turn * (1.0 - down);  // -i sin(phase), both without exp(rise)
    // Of a very small phase the sine has lost its digits.
    const Complex over = std::abs(phase) > 1e-5
                             ? wave / along
                             : Complex(0.0, -2.0 * pi * thickness) * (1.0 - phase * phase / 6.0) * std::exp(-rise);
    const Complex a12 = over * square;
    const Complex a21 = wave * along / square;
    const Transfer old = *this;
    m11 = old.m11 * cosine + old.m12 * a21;
    m12 = old.m11 * a12 + old.m12 * cosine;
    m21 = old.m21 * cosine + old.m22 * a21;
    m22 = old.m21 * a12 + old.m22 * cosine;
    growth += rise;
  }
};

}  // namespace

/// Components of the wave vector along the normal, in units of that in vacuum. Those of the two media are given,
/// because differences of squares have lost their digits at grazing.
struct Film::Normals {
  double rare;
  double dense;
  Complex in_rare;
  Complex in_dense;

  /// The imaginary part is not negative.
  Complex in(Complex ior) const {
    return ior == rare ? in_rare : ior == dense ? in_dense : std::sqrt(ior * ior - rare * rare + in_rare * in_rare);
  }
};

Film::Film(double ior_above, Below below, std::vector<Wave> waves)
    : ior_above_(ior_above),
      ior_below_(below != Below::kMedium || waves.empty() ? ior_above : waves.front().ior_below.real()),
      below_(below),
      lossless_(below != Below::kMetal),
      waves_(std::move(waves)) {
  key_ = {ior_above_, static_cast<double>(below)};
  for (const Wave& wave : waves_) {
    key_.insert(key_.end(), {wave.weight, wave.ior_below.real(), wave.ior_below.imag()});
    for (const Sheet& sheet : wave.sheets) {
      key_.insert(key_.end(), {sheet.ior.real(), sheet.ior.imag(), sheet.thickness});
      lossless_ = lossless_ && sheet.ior.imag() == 0.0;
    }
  }
  const double rare = std::min(ior_above_, ior_below_);
  const double dense = std::max(ior_above_, ior_below_);
  const double largest = std::sqrt(dense * dense - rare * rare);
  passing_ =
      Table(1.0, kExact, [&](double mu) { return sums({rare, dense, rare * mu, std::hypot(largest, rare * mu)}); });
  if (dense > rare && !lossless_) {
    total_ = Table(0.5 * pi, kExact, [&](double angle) {
      return sums({rare, dense, Complex(0.0, largest * std::sin(angle)), largest * std::cos(angle)});
    });
  }
}

Film::Values Film::sums(const Normals& normals) const {
  Values all{};
  for (const Wave& wave : waves_) {
    const Complex above = normals.in(ior_above_);
    const Complex below = normals.in(wave.ior_below);
    Values both{};
    for (const bool in_plane : {false, true}) {
      Transfer films;
      for (const Sheet& sheet : wave.sheets) {
        films.add(normals.in(sheet.ior), in_plane ? sheet.ior * sheet.ior : 1.0, sheet.thickness);
      }
      const Complex first = above / (in_plane ? ior_above_ * ior_above_ : 1.0);
      const Complex last = below / (in_plane ? wave.ior_below * wave.ior_below : 1.0);
      const Complex e = films.m11 + films.m12 * last;
      const Complex h = films.m21 + films.m22 * last;
      const Complex e_back = films.m22 + films.m12 * first;
      const Complex h_back = films.m21 + films.m11 * first;
      const Complex sum = first * e + h;  // of the light from below too, in absolute value
      const double outside = std::norm((first * e - h) / sum);
      const double inside = std::norm((last * e_back - h_back) / sum);
      const double passed = 4.0 * first.real() * last.real() / std::norm(sum) * std::exp(-2.0 * films.growth);
      if (below_ == Below::kPlatelet) {
        // Light to and fro between both faces
        const double lost = 1.0 - inside * inside;
        const double leaves = lost > 0.0 ? passed / lost : 0.0;
        const double reflected = outside + leaves * inside * passed;
        both[0] += 0.5 * reflected;
        both[1] += 0.5 * reflected;
        both[2] += 0.5 * leaves * passed;
      } else {
        both[0] += 0.5 * outside;
        both[1] += 0.5 * inside;
        both[2] += 0.5 * passed;
      }
    }
    for (std::size_t f = 0; f < all.size(); ++f) {
      all[f] += wave.weight * both[f];
    }
  }
  return all;
}

double Film::reflectance(double mu, Side side) const {
  const double here = ior_of(side);
  const double beyond = ior_of(side == Side::kAbove ? Side::kBelow : Side::kAbove);
  const std::size_t function = side == Side::kAbove ? 0 : 1;
  double value = 0.0;
  if (here <= beyond) {
    value = passing_.at(function, mu);
  } else {
    const double refracted2 = 1.0 - (1.0 - mu * mu) * (here / beyond) * (here / beyond);
    if (refracted2 > 0.0) {
      value = passing_.at(function, std::sqrt(refracted2));
    } else if (lossless_) {
      return 1.0;
    } else {
      value = total_.at(function, std::atan2(beyond * std::sqrt(-refracted2), here * mu));
    }
  }
  return std::clamp(value, 0.0, 1.0);
}

double Film::transmittance(double mu, Side side) const {
  if (lossless_) {
    return 1.0 - reflectance(mu, side);
  }
  const double ratio = ior_of(side) / ior_of(side == Side::kAbove ? Side::kBelow : Side::kAbove);
  const double refracted2 = 1.0 - (1.0 - mu * mu) * ratio * ratio;
  if (refracted2 <= 0.0) {
    return 0.0;
  }
  const double x = ratio <= 1.0 ? mu : std::sqrt(refracted2);
  const double reflected = std::clamp(std::max(passing_.at(0, x), passing_.at(1, x)), 0.0, 1.0);
  return std::clamp(passing_.at(2, x), 0.0, 1.0 - reflected);
}

double Film::mean_reflectance() const {
  const Quadrature rule(64);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < rule.mu.size(); ++k) {
    sum += 2.0 * rule.mu[k] * rule.weight[k] * reflectance(rule.mu[k], Side::kAbove);
  }
  return sum;
}

}  // namespace lamina
