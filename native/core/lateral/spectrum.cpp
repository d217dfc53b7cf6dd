// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/spectrum.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "numeric/bessel.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// The limit of an alternating series from its partial sums, by repeated means of neighbours (Euler transform).
double limit_of(std::vector<double> sums) {
  for (std::size_t count = sums.size() - 1; count > 0; --count) {
    for (std::size_t k = 0; k < count; ++k) {
      sums[k] = 0.5 * (sums[k] + sums[k + 1]);
    }
  }
  return sums.front();
}

}  // namespace

double SpectrumPiece::node(double low, double high, int index, int intervals) {
  const double half = std::sin(0.5 * pi * static_cast<double>(index) / static_cast<double>(intervals));
  return index == intervals ? high : low + (high - low) * half * half;
}

double SpectrumPiece::at(double s) const {
  const int last = static_cast<int>(values.size()) - 1;
  double sum = 0.0;
  double whole = 0.0;
  for (int k = 0; k <= last; ++k) {
    const double distance = s - node(low, high, k, last);
    const double value = values[static_cast<std::size_t>(k)];
    if (distance == 0.0) {
      return value;
    }
    const double weight = (k % 2 == 0 ? 1.0 : -1.0) * (k == 0 || k == last ? 0.5 : 1.0) / distance;
    sum += weight * value;
    whole += weight;
  }
  return sum / whole;
}

double SpectrumPiece::roughness() const {
  const int last = static_cast<int>(values.size()) - 1;
  double rest = 0.0;
  for (int order = last - last / 8; order < last; ++order) {
    double sum = 0.0;
    for (int k = 0; k <= last; ++k) {
      const double weight = k == 0 || k == last ? 0.5 : 1.0;
      sum += weight * values[static_cast<std::size_t>(k)] * std::cos(pi * order * k / last);
    }
    rest = std::max(rest, std::abs(2.0 * sum / last));
  }
  return rest;
}

Spectrum::Spectrum(const FrequencyScale& scale, std::vector<SpectrumPiece> pieces, bool singular)
    : scale_(scale), pieces_(std::move(pieces)), fastest_(scale.frequency(pieces_.back().high)) {
  fit_tail(singular);
}

double Spectrum::at(double q) const {
  if (q > fastest_) {
    const double x = fastest_ / q;
    return x * (tail_[0] + x * (tail_[1] - tail_[2] * std::log(x) + x * tail_[3]));
  }
  const double place = scale_.place(q);
  for (const SpectrumPiece& piece : pieces_) {
    if (place <= piece.high) {
      return piece.at(place);
    }
  }
  return pieces_.back().values.back();
}

void Spectrum::fit_tail(bool singular) {
  // Fit the upper end of the known frequencies. A large weight of the last value avoids a step.
  constexpr double kBelow = 6.0;
  constexpr double kLast = 100.0;
  const SpectrumPiece& last = pieces_.back();
  const int intervals = static_cast<int>(last.values.size()) - 1;
  const auto frequency = [&](int k) {
    return scale_.frequency(SpectrumPiece::node(last.low, last.high, k, intervals));
  };
  std::vector<int> known;
  for (int k = 0; k <= intervals; ++k) {
    if (frequency(k) > fastest_ / kBelow) {
      known.push_back(k);
    }
  }
  const Eigen::Index columns = singular ? 4 : 3;
  Eigen::MatrixXd system(static_cast<Eigen::Index>(known.size()), columns);
  Eigen::VectorXd wanted(system.rows());
  for (Eigen::Index row = 0; row < system.rows(); ++row) {
    const int k = known[static_cast<std::size_t>(row)];
    const double x = fastest_ / frequency(k);
    const double weight = (k == intervals ? kLast : 1.0) / (x * x);
    Eigen::Index column = 0;
    if (singular) {
      system(row, column++) = weight * x;
    }
    system(row, column++) = weight * x * x;
    system(row, column++) = -weight * x * x * std::log(x);
    system(row, column) = weight * x * x * x;
    wanted[row] = weight * last.values[static_cast<std::size_t>(k)];
  }
  const Eigen::VectorXd fitted = system.colPivHouseholderQr().solve(wanted);
  for (Eigen::Index k = 0; k < columns; ++k) {
    tail_[static_cast<std::size_t>(k + 4 - columns)] = fitted[k];
  }
}

/// int F(q) B(q r) q^power dq: up to the first root of the Bessel function by pieces that grow with q, then from root
/// to root, where the terms alternate in sign.
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
  // Beyond changes at the scale of `slowest` the terms are smooth, and their sum is extrapolated.
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
  return transformed(r, 1, 2.404825557695773, [](double x) { return bessel_j0(x); }) / (2.0 * pi);
}

double Spectrum::inside(double r) const {
  return r == 0.0 ? 0.0 : r * transformed(r, 0, 3.831705970207512, [](double x) { return bessel_j1(x); });
}

}  // namespace lamina
