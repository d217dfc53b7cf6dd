// SPDX-License-Identifier: GPL-3.0-or-later
// A phase function given by Legendre moments or by samples.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "phase/cosine_table.hpp"
#include "phase/moment_decay.hpp"

namespace lamina {

/// A phase function given by numbers, for example from a Mie code. Copies share the table.
class Tabulated {
 public:
  /// From chi_0 = 1, chi_1, ...: p = sum of (2 l + 1) chi_l P_l. The table holds Hermite cubics with sixteen knots per
  /// wave of the highest polynomial, accurate to about 1e-6 of the peak. p is zero where the series is negative.
  static Tabulated from_moments(const std::vector<double>& chi) {
    constexpr std::size_t kFewest = 256;
    constexpr std::size_t kKnotsPerWave = 16;
    const std::size_t pieces = std::max(kFewest, kKnotsPerWave * (chi.size() - 1));  // even
    std::vector<double> cosines(pieces + 1);
    std::vector<double> values(pieces + 1);
    std::vector<double> slopes(pieces + 1);
    const auto set = [&](std::size_t knot, double cosine, double value, double slope) {
      cosines[knot] = cosine;
      values[knot] = std::max(value, 0.0);
      slopes[knot] = value > 0.0 ? slope : 0.0;
    };
    for (std::size_t k = 0; 2 * k <= pieces; ++k) {
      const double x = std::cos(std::numbers::pi * static_cast<double>(k) / static_cast<double>(pieces));
      const auto [even, odd] = series(chi, x);
      set(pieces - k, x, even.value + odd.value, even.slope + odd.slope);
      set(k, -x, even.value - odd.value, odd.slope - even.slope);
    }
    return Tabulated(CosineTable(cosines, values, slopes), chi);
  }

  /// From samples: cosines ascending from -1 to 1, values in any unit; monotone cubic interpolation.
  static Tabulated from_samples(const std::vector<double>& cosines, const std::vector<double>& values) {
    CosineTable table = CosineTable::through(cosines, values);
    std::vector<double> chi = table.moments(kMostMoments + 1);
    return Tabulated(std::move(table), std::move(chi));
  }

  double evaluate(double cosine) const { return data_->table.evaluate(cosine); }
  double moment(int order) const {
    const auto l = static_cast<std::size_t>(order);
    return l < data_->chi.size() ? data_->chi[l] : 0.0;
  }
  double peak() const { return measured_peak(*this); }
  double sample(double u) const { return data_->table.sample(u); }

 private:
  struct Data {
    CosineTable table;
    std::vector<double> chi;
  };

  Tabulated(CosineTable table, std::vector<double> chi)
      : data_(std::make_shared<const Data>(Data{std::move(table), std::move(chi)})) {}

  /// The sums of the even and of the odd degrees; their sum and difference are the function at x and at -x.
  struct Parts {
    ValueAndSlope even{0.0, 0.0};
    ValueAndSlope odd{0.0, 0.0};
  };
  static Parts series(const std::vector<double>& chi, double x) {
    Parts parts;
    double before = 0.0;
    double now = 1.0;
    double slope_before = 0.0;
    double slope = 0.0;
    for (std::size_t order = 0; order < chi.size(); ++order) {
      const double odd = 2.0 * static_cast<double>(order) + 1.0;
      ValueAndSlope& sum = order % 2 == 0 ? parts.even : parts.odd;
      sum.value += odd * chi[order] * now;
      sum.slope += odd * chi[order] * slope;
      // P_{l+1} = x P_l + (x P_l - P_{l-1}) l / (l + 1), P'_{l+1} = P'_{l-1} + (2 l + 1) P_l.
      const double risen = x * now;
      const double share = (odd - 1.0) / (odd + 1.0);
      const double next = risen + share * (risen - before);
      const double next_slope = slope_before + odd * now;
      before = now;
      now = next;
      slope_before = slope;
      slope = next_slope;
    }
    return parts;
  }

  std::shared_ptr<const Data> data_;
};

}  // namespace lamina
