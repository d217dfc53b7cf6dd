// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "graded_medium.hpp"
#include "guide_heights.hpp"

namespace lamina {

/// A direction, of light or towards the eye: its horizontal part, in the direction of travel, and the cosine with
/// the normal, which is positive whichever way it goes.
struct Ray {
  double x;
  double y;
  double mu;
};

/// Coarse tables that guide the walk of the scattering equation: what S of the slab below each height is, nearly,
/// between any two directions, and what each term of the equation adds there.
///
/// All are linear between points uniform in sqrt(1 - mu), which resolves the normal, and in sin(dphi / 2), which
/// resolves the forward azimuth; of S only what is not single scattering, divided by the angular shape of single
/// scattering, so that thin layers and grazing directions are smooth as well.
class ScatteringGuide {
 public:
  explicit ScatteringGuide(const GradedMedium& medium);

  const GuideHeights& heights() const { return heights_; }

  static constexpr std::size_t kCells = 16;
  static constexpr std::size_t kPoints = kCells + 1;

  /// A value's cell and its place in there.
  struct Place {
    std::size_t cell;
    float fraction;

    static Place of(double x) {
      const double scaled = x * static_cast<double>(kCells);
      const std::size_t cell = std::min(static_cast<std::size_t>(scaled), kCells - 1);
      return {cell, static_cast<float>(scaled - static_cast<double>(cell))};
    }
    static Place of_cosine(double mu) { return of(std::sqrt(std::max(0.0, 1.0 - mu))); }
    /// Of the azimuth between two rays.
    static Place between(const Ray& a, const Ray& b) {
      const double sines = (a.x * a.x + a.y * a.y) * (b.x * b.x + b.y * b.y);
      const double cosine = sines > 1e-24 ? (a.x * b.x + a.y * b.y) / std::sqrt(sines) : 1.0;
      return of(std::sqrt(std::clamp(0.5 - 0.5 * cosine, 0.0, 1.0)));
    }
  };

  /// What the terms of the equation add, for one pair of directions and any height.
  class Terms {
   public:
    Terms(const ScatteringGuide& guide, const Ray& a, const Ray& b);
    /// kS + Sk + SkS at the guide's height j.
    double repeated(std::size_t j) const { return sum(guide_.repeated_.data(), j); }
    /// Light that a, or b, gets from S after scattering once on its way.
    double one_side(std::size_t j, bool a) const {
      return a ? sum(guide_.one_side_.data(), j) : sum_turned(guide_.one_side_.data(), j);
    }

   private:
    double sum(const float* table, std::size_t j) const {
      double total = 0.0;
      for (std::size_t k = 0; k < corners_.size(); ++k) {
        total += static_cast<double>(weights_[k] * table[corners_[k] + j]);
      }
      return total;
    }
    double sum_turned(const float* table, std::size_t j) const {
      double total = 0.0;
      for (std::size_t k = 0; k < corners_.size(); ++k) {
        total += static_cast<double>(weights_[k] * table[turned_[k] + j]);
      }
      return total;
    }

    const ScatteringGuide& guide_;
    std::array<std::size_t, 8> corners_;
    std::array<std::size_t, 8> turned_;
    std::array<float, 8> weights_;
  };

  /// S~(t; ., b) / mu for one direction b and one height, between all other directions.
  class Slice {
   public:
    /// In the cell of heights j, at `up` of its way.
    Slice(const ScatteringGuide& guide, std::size_t j, double up, double t, const Ray& b,
          const LocalScattering& scattering);

    double operator()(const Ray& a) const {
      const Place p = Place::of_cosine(a.mu);
      const Place z = Place::between(a, b_);
      const float* row = &values_[p.cell * kPoints + z.cell];
      const float lower = row[0] + z.fraction * (row[1] - row[0]);
      const float upper = row[kPoints] + z.fraction * (row[kPoints + 1] - row[kPoints]);
      const float smooth = lower + p.fraction * (upper - lower);
      const double once = 0.25 * scattering_.evaluate(a.x * b_.x + a.y * b_.y - a.mu * b_.mu);
      const double shape = (1.0 - std::exp(-t_ * (1.0 / a.mu + 1.0 / b_.mu))) / (a.mu + b_.mu);
      return 4.0 * b_.mu * shape * std::max(1e-3 * once, once + static_cast<double>(smooth));
    }

   private:
    Ray b_;
    double t_;
    const LocalScattering& scattering_;
    std::array<float, kPoints * kPoints> values_;
  };

  /// A direction drawn roughly in proportion to S~(t; ., b) / mu, its density over the hemisphere's solid angle.
  struct Drawn {
    Ray ray;
    double density;
  };
  /// At the guide's height j and the point of the cosine of b; u, v, w uniform in (0, 1).
  Drawn draw(std::size_t j, std::size_t point, const Ray& b, double u, double v, double w) const;

 private:
  static constexpr std::size_t kAzimuths = 8;
  static constexpr std::size_t kBins = kCells * kAzimuths;

  void fill(const GradedMedium& medium);

  GuideHeights heights_;
  std::vector<float> smooth_;      // [height, cosine of b, cosine of a, azimuth]
  std::vector<float> one_side_;    // [cosine of the side, other cosine, azimuth, height]
  std::vector<float> repeated_;    // [cosine, cosine, azimuth, height]
  std::vector<float> cumulative_;  // [height, cosine of b, bin]
};

}  // namespace lamina
