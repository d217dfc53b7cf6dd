// SPDX-License-Identifier: GPL-3.0-or-later
// The phase function of Cornette and Shanks.
#pragma once
#include <cmath>
#include <cstddef>

#include "phase/draine.hpp"

namespace lamina {

/// Cornette and Shanks, "Physically reasonable analytic expression for the single-scattering phase function"
/// (1992): 3/2 (1 - g^2) (1 + cos^2) / ((2 + g^2) (1 + g^2 - 2 g cos)^(3/2)), g in (-1, 1). g = 0 is Rayleigh
/// scattering. The mean cosine is 3 g (4 + g^2) / (5 (2 + g^2)).
class CornetteShanks {
 public:
  static constexpr const char* kKind = "cornette-shanks";
  static constexpr std::size_t kParameters = 1;

  explicit CornetteShanks(double g) : g_(g), factor_(1.5 * (1.0 - g * g) / (2.0 + g * g)), same_as_(g, 1.0) {}

  double evaluate(double cosine) const {
    const double denominator = 1.0 + g_ * g_ - 2.0 * g_ * cosine;
    return factor_ * (1.0 + cosine * cosine) / (denominator * std::sqrt(denominator));
  }
  double moment(int order) const { return same_as_.moment(order); }
  double peak() const { return same_as_.peak(); }
  double sample(double u) const { return same_as_.sample(u); }

 private:
  double g_;
  double factor_;
  Draine same_as_;
};

}  // namespace lamina
