// SPDX-License-Identifier: GPL-3.0-or-later
#include "photon_walk.hpp"

#include <cmath>
#include <numbers>

namespace lamina {

PhotonWalk::PhotonWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi)
    : medium_(medium),
      mu_o_(mu_o),
      mu_i_(mu_i),
      out_x_(std::sqrt(1.0 - mu_o * mu_o) * std::cos(dphi)),
      out_y_(std::sqrt(1.0 - mu_o * mu_o) * std::sin(dphi)) {}

double PhotonWalk::sample(Rng& rng, std::uint64_t& events) const {
  using std::numbers::pi;
  constexpr double kFaint = 0.1;
  const double tau = medium_.tau();
  // The direction of travel, z upwards, and the optical height.
  double x = std::sqrt(1.0 - mu_i_ * mu_i_);
  double y = 0.0;
  double z = -mu_i_;
  double t = tau;
  double weight = 1.0;
  double sum = 0.0;
  while (true) {
    t -= std::log(rng.uniform()) * z;
    if (t <= 0.0 || t >= tau) {
      return sum / mu_o_;
    }
    ++events;
    const LocalScattering scattering = medium_.at(t);
    sum +=
        weight * scattering.evaluate(x * out_x_ + y * out_y_ + z * mu_o_) * (0.25 / pi) * std::exp((t - tau) / mu_o_);
    weight *= scattering.albedo();
    if (weight < kFaint) {
      if (rng.uniform() >= 0.5) {
        return sum / mu_o_;
      }
      weight *= 2.0;
    }
    // Turn by the phase function, in a frame about the direction (Duff et al. 2017).
    const double cosine = scattering.sample(rng.uniform());
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const double azimuth = 2.0 * pi * rng.uniform();
    const double p = sine * std::cos(azimuth);
    const double q = sine * std::sin(azimuth);
    const double sign = std::copysign(1.0, z);
    const double a = -1.0 / (sign + z);
    const double b = x * y * a;
    const double turned_x = p * (1.0 + sign * x * x * a) + q * b + cosine * x;
    const double turned_y = p * sign * b + q * (sign + y * y * a) + cosine * y;
    z = -p * sign * x - q * y + cosine * z;
    x = turned_x;
    y = turned_y;
  }
}

}  // namespace lamina
