// SPDX-License-Identifier: GPL-3.0-or-later
// A tabulated non-negative function of the cosine, with exact sampling.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include "numeric/invert.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {

/// A non-negative function of the cosine on [-1, 1], cubic between ascending knots, scaled so that its mean
/// over the sphere is 1.
class CosineTable {
 public:
  /// Hermite cubics; `slopes` are the derivatives with respect to the cosine at the knots.
  CosineTable(const std::vector<double>& cosines, const std::vector<double>& values, const std::vector<double>& slopes)
      : knots_(cosines), below_(cosines.size(), 0.0) {
    for (std::size_t k = 0; k + 1 < cosines.size(); ++k) {
      const double h = cosines[k + 1] - cosines[k];
      const double secant = (values[k + 1] - values[k]) / h;
      pieces_.push_back({values[k], slopes[k], (3.0 * secant - 2.0 * slopes[k] - slopes[k + 1]) / h,
                         (slopes[k] + slopes[k + 1] - 2.0 * secant) / (h * h)});
      below_[k + 1] = below_[k] + pieces_.back().integral(h);
    }
    const double whole = below_.back();
    const double scale = 2.0 / whole;
    for (Piece& piece : pieces_) {
      piece = {scale * piece.value, scale * piece.slope, scale * piece.square, scale * piece.cube};
    }
    for (double& share : below_) {
      share /= whole;
    }
    make_bins();
  }

  /// Interpolates samples, monotone where they are (Fritsch and Butland 1984) and therefore positive where they are.
  static CosineTable through(const std::vector<double>& cosines, const std::vector<double>& values) {
    return {cosines, values, monotone_slopes(cosines, values)};
  }

  double evaluate(double cosine) const {
    const std::size_t bin = bin_of(cosine);
    const auto first = knots_.begin() + 1;
    const auto above = std::upper_bound(first + first_piece_[bin], first + first_piece_[bin + 1], cosine);
    const auto k = static_cast<std::size_t>(above - first);
    return pieces_[k].at(cosine - knots_[k]);
  }

  /// The cosine at which the cumulative distribution is u.
  double sample(double u) const {
    const auto above = std::upper_bound(below_.begin() + 1, below_.end() - 1, u);
    const auto k = static_cast<std::size_t>(above - below_.begin()) - 1;
    const Piece& piece = pieces_[k];
    const double h = knots_[k + 1] - knots_[k];
    const double share = below_[k + 1] - below_[k];
    if (!(share > 0.0)) {
      return knots_[k];
    }
    const double wanted = 2.0 * (u - below_[k]);
    const auto excess = [&](double s) -> ValueAndSlope { return {piece.integral(s) - wanted, piece.at(s)}; };
    return knots_[k] + invert_increasing(excess, 0.0, h, h * std::clamp((u - below_[k]) / share, 0.0, 1.0));
  }

  /// chi_0 to chi_{count-1}, by Gauss quadrature in each piece, with enough nodes for the highest polynomial.
  std::vector<double> moments(int count) const {
    std::vector<double> points;
    std::vector<double> shares;
    std::map<int, Quadrature> rules;
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      const double h = knots_[k + 1] - knots_[k];
      const double angle = std::acos(std::max(knots_[k], -1.0)) - std::acos(std::min(knots_[k + 1], 1.0));
      const int nodes = 7 + static_cast<int>(0.5 * angle * count);
      const Quadrature& rule = rules.try_emplace(nodes, nodes).first->second;
      for (Eigen::Index i = 0; i < rule.mu.size(); ++i) {
        const double s = h * rule.mu[i];
        points.push_back(knots_[k] + s);
        shares.push_back(0.5 * h * rule.weight[i] * pieces_[k].at(s));
      }
    }
    return legendre_sums(points, shares, count);
  }

 private:
  /// value + slope s + square s^2 + cube s^3, s from the lower knot.
  struct Piece {
    double value;
    double slope;
    double square;
    double cube;
    double at(double s) const { return value + s * (slope + s * (square + s * cube)); }
    double integral(double s) const { return s * (value + s * (0.5 * slope + s * (square / 3.0 + s * 0.25 * cube))); }
  };

  /// Bins roughly uniform in the angle, which limit the search for a piece.
  std::size_t bin_of(double cosine) const {
    const double place =
        cosine < 0.0 ? std::sqrt(std::max(1.0 + cosine, 0.0)) : 2.0 - std::sqrt(std::max(1.0 - cosine, 0.0));
    return std::min(static_cast<std::size_t>(place * bins_per_unit_), first_piece_.size() - 2);
  }

  void make_bins() {
    const std::size_t bins = 2 * pieces_.size();
    bins_per_unit_ = 0.5 * static_cast<double>(bins);
    first_piece_.assign(bins + 1, static_cast<std::ptrdiff_t>(pieces_.size()) - 1);
    first_piece_.front() = 0;
    // The first piece of each bin is that of the bin's lower end; bin_of increases with the cosine.
    std::size_t bin = 0;
    for (std::size_t k = 0; k + 1 < pieces_.size(); ++k) {
      for (const std::size_t end = bin_of(knots_[k + 1]); bin < end;) {
        first_piece_[++bin] = static_cast<std::ptrdiff_t>(k);
      }
    }
  }

  static std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
    const std::size_t last = x.size() - 1;
    std::vector<double> h(last);
    std::vector<double> secant(last);
    for (std::size_t k = 0; k < last; ++k) {
      h[k] = x[k + 1] - x[k];
      secant[k] = (y[k + 1] - y[k]) / h[k];
    }
    std::vector<double> slopes(last + 1, secant[0]);
    if (last == 1) {
      return slopes;
    }
    for (std::size_t k = 1; k < last; ++k) {
      const double before = h[k] * 2.0 + h[k - 1];
      const double after = h[k] + 2.0 * h[k - 1];
      const bool turns = secant[k - 1] * secant[k] <= 0.0;
      slopes[k] = turns ? 0.0 : (before + after) / (before / secant[k - 1] + after / secant[k]);
    }
    slopes[0] = end_slope(h[0], h[1], secant[0], secant[1]);
    slopes[last] = end_slope(h[last - 1], h[last - 2], secant[last - 1], secant[last - 2]);
    return slopes;
  }

  /// The slope at an end, from a parabola, limited so that the first piece stays monotone.
  static double end_slope(double h, double next_h, double secant, double next_secant) {
    const double slope = ((2.0 * h + next_h) * secant - h * next_secant) / (h + next_h);
    if (slope * secant <= 0.0) {
      return 0.0;
    }
    const bool turns = secant * next_secant <= 0.0;
    return turns && std::abs(slope) > 3.0 * std::abs(secant) ? 3.0 * secant : slope;
  }

  /// Sums of shares times P_l at the points.
  static std::vector<double> legendre_sums(std::vector<double> points, std::vector<double> shares, int count) {
    constexpr std::size_t kLane = 16;  // points summed together, for vector registers
    using Lane = std::array<double, kLane>;
    while (points.size() % kLane != 0) {
      points.push_back(0.0);
      shares.push_back(0.0);
    }
    std::vector<double> sums(static_cast<std::size_t>(count), 0.0);
    for (std::size_t first = 0; first < points.size(); first += kLane) {
      Lane before{};
      Lane now{};
      now.fill(1.0);
      for (int l = 0; l < count; ++l) {
        const double up = (2.0 * l + 1.0) / (l + 1.0);
        const double down = l / (l + 1.0);
        double sum = 0.0;
        for (std::size_t i = 0; i < kLane; ++i) {
          sum += shares[first + i] * now[i];
          const double next = up * points[first + i] * now[i] - down * before[i];
          before[i] = now[i];
          now[i] = next;
        }
        sums[static_cast<std::size_t>(l)] += sum;
      }
    }
    return sums;
  }

  std::vector<double> knots_;
  std::vector<double> below_;  // cumulative distribution at each knot
  std::vector<Piece> pieces_;
  std::vector<std::ptrdiff_t> first_piece_;  // of each bin
  double bins_per_unit_ = 0.0;
};

}  // namespace lamina
