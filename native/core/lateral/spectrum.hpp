// SPDX-License-Identifier: GPL-3.0-or-later
// A function of lateral frequency, and the flux density of which it is the transform.
#pragma once
#include <vector>

namespace lamina {

/// The frequencies at which a spectrum is known: Chebyshev's extrema in s, q = slowest sinh(s), from 0 to `fastest`. A
/// spectrum that is smooth on the scale of q both below and far above `slowest` is smooth in s.
struct FrequencyScale {
  double slowest = 1.0;  ///< 1/mm
  double fastest = 20.0;

  double end() const;
  double frequency(double s) const;
  double place(double q) const;
  /// Of `intervals` + 1 frequencies number `index`, ascending; those of half as many intervals are every second one.
  double node(int index, int intervals) const;
};

/// A spectrum F(q) that falls at least as 1 / q, and the flux density of which it is the integral with J0(q r).
class Spectrum {
 public:
  Spectrum() = default;
  /// `values` at all nodes of the scale. `singular`: it may fall as 1 / q, else it falls as log(q) / q^2 or faster.
  Spectrum(const FrequencyScale& scale, std::vector<double> values, bool singular);

  double at(double q) const;
  /// Flux density 1 / (2 pi) int F(q) J0(q r) q dq, 1/mm^2, r > 0.
  double density(double r) const;
  /// Flux within the radius, r int F(q) J1(q r) dq.
  double inside(double r) const;
  /// The last Chebyshev coefficients over the largest value: what interpolation still misses.
  double roughness() const;

 private:
  template <typename Bessel>
  double transformed(double r, int power, double first_root, const Bessel& bessel) const;
  void fit_tail(bool singular);

  FrequencyScale scale_;
  std::vector<double> values_;
  std::vector<double> weights_;            // barycentric
  double tail_[4] = {0.0, 0.0, 0.0, 0.0};  // of fastest / q: first power, square, square times log(q / fastest), cube
};

}  // namespace lamina
