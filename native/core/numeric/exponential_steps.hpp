// SPDX-License-Identifier: GPL-3.0-or-later
// An exponential Runge-Kutta integrator with step control, for stiff decay.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace lamina {

/// Integrates du/dt = -r u + F(t, u) for arrays, where r >= 0 may be arbitrarily large in any element. An exponential
/// Runge-Kutta method of stiff order 4 (Hochbruck and Ostermann 2005, equation 5.19). Each step is compared with two
/// half steps, which give the error and extrapolate to order 5.
class ExponentialSteps {
 public:
  using Array = Eigen::ArrayXXd;

  ExponentialSteps(Array rates, double tolerance) : rates_(std::move(rates)), tolerance_(tolerance) {}

  /// Integrates from t to `end`. `step` is the first step to try, and becomes the last step taken. The error of a step
  /// is held below the tolerance times the largest element, or times 1 if that is larger.
  template <typename Force>
  void integrate(double t, double end, double& step, Array& u, const Force& force) {
    while (t < end) {
      const bool last = t + step >= end * (1.0 - 1e-14);
      const double h = last ? end - t : step;
      prepare(h);
      const Array once = advanced(whole_, t, h, u, force);
      const Array middle = advanced(half_, t, 0.5 * h, u, force);
      const Array twice = advanced(half_, t + 0.5 * h, 0.5 * h, middle, force);
      const Array correction = (twice - once) / 15.0;
      const double error = correction.abs().maxCoeff() / (tolerance_ * std::max(1.0, twice.abs().maxCoeff()));
      const double factor = std::clamp(0.85 * std::pow(std::max(error, 1e-12), -0.2), 0.2, 4.0);
      if (error <= 1.0) {
        u = twice + correction;
        t = last ? end : t + h;
        ++taken_;
        step = std::max(step, h) == h || factor < 1.0 ? h * factor : step;
      } else {
        step = h * std::min(factor, 0.5);
      }
    }
  }

  int taken() const { return taken_; }

 private:
  struct Coefficients {
    double h = 0.0;
    Array half_fall, fall;
    Array a21, a31, a32, a41, a42, a51, a52, a54;
    Array b1, b4, b5;
  };

  static std::array<double, 4> phi(double z) {
    if (z > -0.5) {
      double third = 0.0;
      for (int k = 16; k >= 3; --k) {
        third = third * z / (k + 1.0) + 1.0;
      }
      third /= 6.0;
      const double second = 0.5 + z * third;
      const double first = 1.0 + z * second;
      return {1.0 + z * first, first, second, third};
    }
    const double first = std::expm1(z) / z;
    const double second = (first - 1.0) / z;
    return {std::exp(z), first, second, (second - 0.5) / z};
  }

  void fill(Coefficients& c, double h) const {
    if (c.h == h) {
      return;
    }
    c.h = h;
    for (Array* array :
         {&c.half_fall, &c.fall, &c.a21, &c.a31, &c.a32, &c.a41, &c.a42, &c.a51, &c.a52, &c.a54, &c.b1, &c.b4, &c.b5}) {
      array->resize(rates_.rows(), rates_.cols());
    }
    for (Eigen::Index k = 0; k < rates_.size(); ++k) {
      const double z = -h * rates_(k);
      const auto [fall, p1, p2, p3] = phi(z);
      const auto [half_fall, q1, q2, q3] = phi(0.5 * z);
      c.fall(k) = fall;
      c.half_fall(k) = half_fall;
      c.a21(k) = 0.5 * q1;
      c.a31(k) = 0.5 * q1 - q2;
      c.a32(k) = q2;
      c.a41(k) = p1 - 2.0 * p2;
      c.a42(k) = p2;
      c.a52(k) = 0.5 * q2 - p3 + 0.25 * p2 - 0.5 * q3;
      c.a54(k) = 0.25 * q2 - c.a52(k);
      c.a51(k) = 0.5 * q1 - 2.0 * c.a52(k) - c.a54(k);
      c.b1(k) = p1 - 3.0 * p2 + 4.0 * p3;
      c.b4(k) = -p2 + 4.0 * p3;
      c.b5(k) = 4.0 * p2 - 8.0 * p3;
    }
  }

  void prepare(double h) {
    fill(whole_, h);
    fill(half_, 0.5 * h);
  }

  template <typename Force>
  static Array advanced(const Coefficients& c, double t, double h, const Array& u, const Force& force) {
    const Array g1 = force(t, u);
    const Array middle = c.half_fall * u;
    const Array g2 = force(t + 0.5 * h, (middle + h * c.a21 * g1).eval());
    const Array g3 = force(t + 0.5 * h, (middle + h * (c.a31 * g1 + c.a32 * g2)).eval());
    const Array far = c.fall * u;
    const Array g4 = force(t + h, (far + h * (c.a41 * g1 + c.a42 * (g2 + g3))).eval());
    const Array g5 = force(t + 0.5 * h, (middle + h * (c.a51 * g1 + c.a52 * (g2 + g3) + c.a54 * g4)).eval());
    return far + h * (c.b1 * g1 + c.b4 * g4 + c.b5 * g5);
  }

  Array rates_;
  double tolerance_;
  Coefficients whole_;
  Coefficients half_;
  int taken_ = 0;
};

}  // namespace lamina
