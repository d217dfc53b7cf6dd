// SPDX-License-Identifier: GPL-3.0-or-later
// Coarse tables of the terms of the integral scattering equation, by height and direction.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "guided/guide_heights.hpp"
#include "matter/graded_medium.hpp"
#include "walks/slab_ray.hpp"

namespace lamina {

class ReflectionByHeight;

/// Coarse tables that guide the walk of the scattering equation: approximations of S of the slab below each height, and
/// of each term of the equation there, for any two directions.
///
/// The tables are linear between points uniform in sqrt(1 - mu), which resolves the normal, and in sin(dphi / 2), which
/// resolves the forward azimuth. The table of S holds S without single scattering and without the unscattered
/// reflection from the surface below, divided by the angular shape of single scattering: this is smooth for thin layers
/// and at grazing angles too. Both parts that are left out are added in closed form.
class ScatteringGuide {
 public:
  explicit ScatteringGuide(const GradedMedium& medium);

  const GuideHeights& heights() const { return heights_; }

  static constexpr std::size_t kCells = 12;  ///< of each axis of the tables; walks are unbiased for any number
  static constexpr std::size_t kPoints = kCells + 1;
  using Column = GuideHeights::Column;

  /// The cell of a value in [0, 1], and the fraction of the way through the cell.
  struct Place {
    std::size_t cell;
    float fraction;

    static Place of(double x) {
      const double scaled = x * static_cast<double>(kCells);
      const std::size_t cell = std::min(static_cast<std::size_t>(scaled), kCells - 1);
      return {cell, static_cast<float>(scaled - static_cast<double>(cell))};
    }
    static Place of_cosine(double mu) { return of(std::sqrt(std::max(0.0, 1.0 - mu))); }
    /// For the azimuth between two rays.
    static Place between(const SlabRay& a, const SlabRay& b) {
      const double sines = (a.x * a.x + a.y * a.y) * (b.x * b.x + b.y * b.y);
      const double cosine = sines > 1e-24 ? (a.x * b.x + a.y * b.y) / std::sqrt(sines) : 1.0;
      return of(std::sqrt(std::clamp(0.5 - 0.5 * cosine, 0.0, 1.0)));
    }
  };

  /// The terms of the equation for one pair of directions, at any height.
  class Terms {
   public:
    Terms(const ScatteringGuide& guide, const SlabRay& a, const SlabRay& b);
    /// kS + Sk + SkS at the guide's heights.
    Column repeated() const {
      Column sum = weights_[0] * guide_.repeated_[corners_[0]];
      for (std::size_t k = 1; k < corners_.size(); ++k) {
        sum += weights_[k] * guide_.repeated_[corners_[k]];
      }
      return sum;
    }
    /// The term in which light from S is scattered into a (`of_a`) or into b, at `up` of the cell of heights j.
    double one_side(std::size_t j, double up, bool of_a) const {
      float low = 0.0F;
      float high = 0.0F;
      const std::array<std::size_t, 8>& corners = of_a ? corners_ : turned_;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const float* column = guide_.one_side_[corners[k]].data() + j;
        low += weights_[k] * column[0];
        high += weights_[k] * column[1];
      }
      return static_cast<double>(low) + up * static_cast<double>(high - low);
    }

   private:
    const ScatteringGuide& guide_;
    std::array<std::size_t, 8> corners_;
    std::array<std::size_t, 8> turned_;
    std::array<float, 8> weights_;
  };

  /// S~(t; a, b), where the height t lies in the cell of heights j, at the fraction `up` of the cell.
  double value(std::size_t j, double up, double t, const SlabRay& a, const SlabRay& b,
               const LocalScattering& scattering) const;

  /// The tables for one direction b: values of S~(t; ., b) / mu, and sampling of directions in proportion to it.
  /// Densities are over the solid angle of the hemisphere.
  class Section {
   public:
    /// `j`, `up` and `t` as in value(). `u` and `v`, uniform in [0, 1), choose one of the four neighbouring tables for
    /// sampling.
    Section(const ScatteringGuide& guide, std::size_t j, double up, double t, const SlabRay& b,
            const LocalScattering& scattering, double u, double v);

    /// S~(t; a, b) / mu_a for many directions a; 0 where mu_a is not positive.
    template <typename Values>
    Values operator()(const Values& x, const Values& y, const Values& mu) const;

    /// Samples a direction; u, v, w are uniform in (0, 1).
    SlabRay draw(double u, double v, double w) const;
    /// The density of draw().
    template <typename Values>
    Values density(const Values& x, const Values& y, const Values& mu) const;

   private:
    SlabRay b_;
    double t_;
    const LocalScattering& scattering_;
    float ground_;
    float cosine_;  ///< of the azimuth of b
    float sine_;
    const std::uint8_t* slots_;
    const std::uint8_t* counts_;
    std::array<float, kPoints * kPoints> values_;
  };

 private:
  static constexpr std::size_t kAzimuths = 10;  // bins in half a turn
  static constexpr std::size_t kBins = kCells * kAzimuths;
  static constexpr std::size_t kSlots = 512;  // about four per bin

  struct Grid;

  void tabulate(const GradedMedium& medium);
  double add_order(const ReflectionByHeight& reflection, const Grid& grid, int m);
  void tabulate_bins(const GradedMedium& medium);

  GuideHeights heights_;
  double ground_;                     // reflectance of the surface below
  std::vector<float> smooth_;         // [height, cosine of b, cosine of a, azimuth]
  std::vector<Column> one_side_;      // [cosine of the side, other cosine, azimuth]
  std::vector<Column> repeated_;      // [cosine, cosine, azimuth]
  std::vector<std::uint8_t> slots_;   // [height, cosine of b, slot]: its bin
  std::vector<std::uint8_t> counts_;  // [height, cosine of b, bin]: its number of slots
};

template <typename Values>
Values ScatteringGuide::Section::operator()(const Values& x, const Values& y, const Values& mu) const {
  constexpr auto kScale = static_cast<float>(kCells);
  constexpr float kLast = kScale - 1e-3F;
  const Values positive = mu.max(1e-6F);
  const Values sine = (1.0F - positive * positive).max(1e-12F).sqrt();
  const Values place = (kScale * (1.0F - positive).max(0.0F).sqrt()).min(kLast);
  const Values along = (x * cosine_ + y * sine_) / sine;
  const Values azimuth = (kScale * (0.5F - 0.5F * along).max(0.0F).min(1.0F).sqrt()).min(kLast);
  Values smooth;
  for (Eigen::Index k = 0; k < smooth.size(); ++k) {
    const int i = static_cast<int>(place[k]);
    const int z = static_cast<int>(azimuth[k]);
    const float* row = &values_[static_cast<std::size_t>(i) * kPoints + static_cast<std::size_t>(z)];
    const float f = azimuth[k] - static_cast<float>(z);
    const float lower = row[0] + f * (row[1] - row[0]);
    const float upper = row[kPoints] + f * (row[kPoints + 1] - row[kPoints]);
    smooth[k] = lower + (place[k] - static_cast<float>(i)) * (upper - lower);
  }
  const auto b_mu = static_cast<float>(b_.mu);
  const Values cosine = static_cast<float>(b_.x) * x + static_cast<float>(b_.y) * y - b_mu * mu;
  const Values once = 0.25F * scattering_.evaluate_all(cosine);
  const Values kept = (static_cast<float>(-t_) * (positive.inverse() + 1.0F / b_mu)).exp();
  const Values shape = (1.0F - kept) / (positive + b_mu);
  return (mu > 1e-6F).select(4.0F * b_mu * (shape * (once + smooth.max(-0.5F * once)) + ground_ * kept), 0.0F);
}

template <typename Values>
Values ScatteringGuide::Section::density(const Values& x, const Values& y, const Values& mu) const {
  const Values positive = mu.max(1e-6F).min(1.0F);
  const Values sine = (1.0F - positive * positive).max(1e-12F).sqrt();
  const Values root = (1.0F - positive).max(1e-12F).sqrt();
  const Values along = ((x * cosine_ + y * sine_) / sine).max(-1.0F).min(1.0F);
  // tan(dphi / 4) from cos(dphi / 2)
  const Values half = (0.5F + 0.5F * along).sqrt();
  const Values turn = ((1.0F - half) / (1.0F + half)).sqrt();
  Values density;
  for (Eigen::Index k = 0; k < density.size(); ++k) {
    const auto i = std::min(static_cast<std::size_t>(root[k] * static_cast<float>(kCells)), kCells - 1);
    const auto z = std::min(static_cast<std::size_t>(turn[k] * static_cast<float>(kAzimuths)), kAzimuths - 1);
    density[k] = static_cast<float>(counts_[i * kAzimuths + z]);
  }
  constexpr auto kWhole = static_cast<float>(static_cast<double>(kBins) / (16.0 * static_cast<double>(kSlots)));
  return kWhole * density * (1.0F + turn * turn) / root;
}

}  // namespace lamina
