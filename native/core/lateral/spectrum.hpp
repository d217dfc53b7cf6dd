// SPDX-License-Identifier: GPL-3.0-or-later
// A function of lateral frequency, and the flux density of which it is the Hankel transform.
#pragma once
#include <array>
#include <cmath>
#include <vector>

namespace lamina {

/// A frequency scale q = slowest sinh(s). A spectrum with features at `slowest` and at much higher frequencies is
/// smooth in s.
struct FrequencyScale {
  double slowest = 1.0;  ///< 1/mm

  double frequency(double s) const { return slowest * std::sinh(s); }
  double place(double q) const { return std::asinh(q / slowest); }
};

/// A piece of a spectrum, known at the Chebyshev extrema in s.
struct SpectrumPiece {
  double low = 0.0;  ///< in s
  double high = 1.0;
  std::vector<double> values;

  /// Node `index` of `intervals` + 1, ascending. Every second node is a node of half as many intervals.
  static double node(double low, double high, int index, int intervals);

  double at(double s) const;
  /// The largest of the last Chebyshev coefficients, an estimate of the interpolation error.
  double roughness() const;
};

/// A spectrum F(q) that falls at least as 1 / q, and the flux density that is its integral with J0(q r).
class Spectrum {
 public:
  Spectrum() = default;
  /// `pieces`: ascending, without gaps. `singular`: true if F may fall as 1 / q, false if it falls at least as log(q) /
  /// q^2.
  Spectrum(const FrequencyScale& scale, std::vector<SpectrumPiece> pieces, bool singular);

  double at(double q) const;
  /// Flux density 1 / (2 pi) int F(q) J0(q r) q dq, 1/mm^2, r > 0.
  double density(double r) const;
  /// Flux within the radius, r int F(q) J1(q r) dq.
  double inside(double r) const;

 private:
  template <typename Bessel>
  double transformed(double r, int power, double first_root, const Bessel& bessel) const;
  void fit_tail(bool singular);

  FrequencyScale scale_;
  std::vector<SpectrumPiece> pieces_;
  double fastest_ = 1.0;
  std::array<double, 4> tail_{};  // coefficients of x, x^2, -x^2 log(x) and x^3 with x = fastest / q
};

}  // namespace lamina
