// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/spectrum.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Wynn's epsilon algorithm: the limit of a series of alternating terms from its partial sums.
double limit_of(std::vector<double> sums) {
  std::vector<double> before(sums.size() + 1, 0.0);
  double best = sums.back();
  for (int round = 1; sums.size() > 1; ++round) {
    std::vector<double> next;
    for (std::size_t k = 0; k + 1 < sums.size(); ++k) {
      const double step = sums[k + 1] - sums[k];
      if (step == 0.0) {
        return round % 2 == 1 ? sums[k + 1] : best;
      }
      next.push_back(before[k + 1] + 1.0 / step);
    }
    before = std::move(sums);
    sums = std::move(next);
    if (round % 2 == 0) {
      best = sums.back();
    }
  }
  return best;
}

}  // namespace

double FrequencyScale::end() const { return std::asinh(fastest / slowest); }
double FrequencyScale::frequency(double s) const { return slowest * std::sinh(s); }
double FrequencyScale::place(double q) const { return std::asinh(q / slowest); }

double FrequencyScale::node(int index, int intervals) const {
  if (index == intervals) {
    return fastest;
  }
  const double angle = 0.5 * pi * static_cast<double>(index) / static_cast<double>(intervals);
  return frequency(end() * std::sin(angle) * std::sin(angle));
}

Spectrum::Spectrum(const FrequencyScale& scale, std::vector<double> values, bool singular)
    : scale_(scale), values_(std::move(values)), weights_(values_.size(), 1.0) {
  for (std::size_t k = 1; k < weights_.size(); k += 2) {
    weights_[k] = -1.0;
  }
  weights_.front() *= 0.5;
  weights_.back() *= 0.5;
  fit_tail(singular);
}

double Spectrum::at(double q) const {
  if (q > scale_.fastest) {
    const double x = scale_.fastest / q;
    return x * (tail_[0] + x * (tail_[1] - tail_[2] * std::log(x) + x * tail_[3]));
  }
  const double place = scale_.place(q) / scale_.end();
  const int last = static_cast<int>(values_.size()) - 1;
  double sum = 0.0;
  double whole = 0.0;
  for (int k = 0; k <= last; ++k) {
    const double half = std::sin(0.5 * pi * k / last);
    const double distance = place - half * half;
    const auto index = static_cast<std::size_t>(k);
    if (distance == 0.0) {
      return values_[index];
    }
    sum += weights_[index] / distance * values_[index];
    whole += weights_[index] / distance;
  }
  return sum / whole;
}

void Spectrum::fit_tail(bool singular) {
  // The upper end of what is known; the last value counts most, so that there is no step.
  constexpr double kBelow = 6.0;
  constexpr double kLast = 100.0;
  const int intervals = static_cast<int>(values_.size()) - 1;
  std::vector<int> known;
  for (int k = 0; k <= intervals; ++k) {
    if (scale_.node(k, intervals) > scale_.fastest / kBelow) {
      known.push_back(k);
    }
  }
  const Eigen::Index columns = singular ? 4 : 3;
  Eigen::MatrixXd system(static_cast<Eigen::Index>(known.size()), columns);
  Eigen::VectorXd wanted(system.rows());
  for (Eigen::Index row = 0; row < system.rows(); ++row) {
    const int k = known[static_cast<std::size_t>(row)];
    const double x = scale_.fastest / scale_.node(k, intervals);
    const double weight = (k == intervals ? kLast : 1.0) / (x * x);
    Eigen::Index column = 0;
    if (singular) {
      system(row, column++) = weight * x;
    }
    system(row, column++) = weight * x * x;
    system(row, column++) = -weight * x * x * std::log(x);
    system(row, column) = weight * x * x * x;
    wanted[row] = weight * values_[static_cast<std::size_t>(k)];
  }
  const Eigen::VectorXd fitted = system.colPivHouseholderQr().solve(wanted);
  for (Eigen::Index k = 0; k < columns; ++k) {
    tail_[k + 4 - columns] = fitted[k];
  }
}

/// int F(q) B(q r) q^power dq: up to the first root of the Bessel function by pieces that grow with q, then from root
/// to root, where the terms alternate.
template <typename Bessel>
double Spectrum::transformed(double r, int power, double first_root, const Bessel& bessel) const {
  static const Quadrature rule(12);
  const auto piece = [&](double low, double high) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < rule.mu.size(); ++i) {
      const double q = low + (high - low) * rule.mu[i];
      sum += rule.weight[i] * at(q) * bessel(q * r) * (power == 1 ? q : 1.0);
    }
    return (high - low) * sum;
  };
  constexpr double kPiece = 0.5;  // in s
  const double root = first_root / r;
  double sum = 0.0;
  const double end = scale_.place(root);
  const int pieces = static_cast<int>(std::ceil(end / kPiece));
  for (int k = 0; k < pieces; ++k) {
    sum += piece(scale_.frequency(end * k / pieces), scale_.frequency(end * (k + 1) / pieces));
  }
  // Past what changes at `slowest` the terms are smooth, and their sum is extrapolated.
  constexpr int kExtrapolated = 24;
  constexpr int kMostDirect = 400;
  const int direct = static_cast<int>(std::clamp(8.0 * scale_.slowest * r / pi, 2.0, double(kMostDirect)));
  std::vector<double> sums;
  for (int k = 0; k < direct + kExtrapolated; ++k) {
    sum += piece(root + pi * k / r, root + pi * (k + 1) / r);
    if (k >= direct) {
      sums.push_back(sum);
    }
  }
  return limit_of(std::move(sums));
}

double Spectrum::density(double r) const {
  return transformed(r, 1, 2.404825557695773, [](double x) { return j0(x); }) / (2.0 * pi);
}

double Spectrum::inside(double r) const {
  return r == 0.0 ? 0.0 : r * transformed(r, 0, 3.831705970207512, [](double x) { return j1(x); });
}

double Spectrum::roughness() const {
  const int last = static_cast<int>(values_.size()) - 1;
  double largest = 0.0;
  for (const double value : values_) {
    largest = std::max(largest, std::abs(value));
  }
  double rest = 0.0;
  for (int order = last - last / 8; order < last; ++order) {
    double sum = 0.0;
    for (int k = 0; k <= last; ++k) {
      const double weight = k == 0 || k == last ? 0.5 : 1.0;
      sum += weight * values_[static_cast<std::size_t>(k)] * std::cos(pi * order * k / last);
    }
    rest = std::max(rest, std::abs(2.0 * sum / last));
  }
  return largest > 0.0 ? rest / largest : 0.0;
}

}  // namespace lamina
