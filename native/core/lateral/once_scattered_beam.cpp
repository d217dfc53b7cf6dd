// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/once_scattered_beam.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "lateral/fine_quadrature.hpp"
#include "operators/directions.hpp"

namespace lamina {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// (1 - exp(-z)) / z.
Complex mean_decay(Complex z) {
  if (std::abs(z) < 1e-3) {
    return 1.0 - z * (0.5 - z * (1.0 / 6.0 - z / 24.0));
  }
  return (1.0 - std::exp(-z)) / z;
}

const AzimuthRule& fine_azimuths() {
  static const AzimuthRule rule(32, 0.7, 1);
  return rule;
}

}  // namespace

Complex once_attenuated(Complex rate, Complex beam, double tau, bool away) {
  if (std::isinf(tau)) {
    return away ? 1.0 / (rate + beam) : 0.0;
  }
  if (away) {
    return tau * mean_decay(tau * (rate + beam));
  }
  // The integral is symmetric in both exponents; take the form with a decaying exponential.
  return rate.real() >= beam.real() ? std::exp(-tau * beam) * tau * mean_decay(tau * (rate - beam))
                                    : std::exp(-tau * rate) * tau * mean_decay(tau * (beam - rate));
}

double truncated_phase(const TruncatedMedium& medium, double cosine) {
  double before = 0.0;
  double now = 1.0;
  double sum = 0.0;
  for (std::size_t l = 0; l < medium.moments.size(); ++l) {
    const auto order = static_cast<double>(l);
    sum += (2.0 * order + 1.0) * medium.moments[l] * now;
    const double next = ((2.0 * order + 1.0) * cosine * now - order * before) / (order + 1.0);
    before = now;
    now = next;
  }
  return sum;
}

OnceScatteredBeam::OnceScatteredBeam(const LateralMedium& medium, const Directions& directions, Beam beam,
                                     std::function<double(double)> passing, double critical,
                                     std::vector<Crossed> crossed)
    : medium_(&medium),
      directions_(&directions),
      beam_(beam),
      passing_(std::move(passing)),
      critical_(critical),
      crossed_(std::move(crossed)),
      tau_(medium.medium().tau) {
  const TruncatedMedium& truncated = medium.medium();
  const Nodes fine = between_cosines(critical);
  for (std::size_t k = 0; k < fine.place.size(); ++k) {
    const double mu = fine.place[k];
    mu_.push_back(mu);
    weight_.push_back(0.5 * fine.weight[k] * passing_(mu));
    const double own = truncated.single_scattering_albedo();
    own_.turned.push_back(own * medium.phase().evaluate(-mu));
    own_.forward.push_back(own * medium.phase().evaluate(mu));
    truncated_.turned.push_back(own_.turned.back());
    truncated_.forward.push_back(truncated.albedo * truncated_phase(truncated, mu));
  }
}

OnceScatteredBeam::Crossing OnceScatteredBeam::crossing(double mu) const {
  Crossing crossing;
  for (const Crossed& other : crossed_) {
    const double cosine = refracted_cosine(mu, 1.0, other.ior);
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    crossing.optical += other.extinction * other.thickness / cosine;
    crossing.aside += other.thickness * sine / cosine;
  }
  return crossing;
}

double OnceScatteredBeam::spectrum(double q, const Phases& phases) const {
  const AzimuthRule& azimuths = fine_azimuths();
  const double slant = q / medium_->extinction();
  double sum = 0.0;
  for (std::size_t k = 0; k < mu_.size(); ++k) {
    const double sine = std::sqrt(1.0 - mu_[k] * mu_[k]);
    const double turned = beam_.away * phases.turned[k];
    const double forward = beam_.towards * phases.forward[k];
    const Crossing crossed = crossing(mu_[k]);
    double mean = 0.0;
    for (Eigen::Index j = 0; j < azimuths.cosines.size(); ++j) {
      const Complex rate = (1.0 + Complex(0.0, slant * sine) * azimuths.cosines[j]) / mu_[k];
      const Complex on_the_way = std::exp(-crossed.optical - Complex(0.0, q * crossed.aside) * azimuths.cosines[j]);
      mean += (azimuths.weights[j] * on_the_way *
               (turned * once_attenuated(rate, 1.0, tau_, true) + forward * once_attenuated(rate, 1.0, tau_, false)))
                  .real();
    }
    sum += weight_[k] * mean;
  }
  return sum;
}

double OnceScatteredBeam::at(double q) const { return spectrum(q, truncated_); }
double OnceScatteredBeam::whole_at(double q) const { return spectrum(q, own_); }

double OnceScatteredBeam::discretised(double q, const AzimuthRule& azimuths) const {
  const TruncatedMedium& medium = medium_->medium();
  const double slant = q / medium_->extinction();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < directions_->live; ++i) {
    const double mu = directions_->mu[i];
    if (mu <= critical_) {
      continue;
    }
    const double sine = std::sqrt(1.0 - mu * mu);
    const double turned = beam_.away * medium.albedo * truncated_phase(medium, -mu);
    const double forward = beam_.towards * medium.albedo * truncated_phase(medium, mu);
    const Crossing crossed = crossing(mu);
    const auto scattered = [&](Complex cosine) {
      const Complex rate = (1.0 + Complex(0.0, slant * sine) * cosine) / mu;
      const Complex on_the_way = std::exp(-crossed.optical - Complex(0.0, q * crossed.aside) * cosine);
      return on_the_way *
             (turned * once_attenuated(rate, 1.0, tau_, true) + forward * once_attenuated(rate, 1.0, tau_, false));
    };
    double mean = azimuths.count == 1 ? scattered(0.0).real() : 0.0;
    for (Eigen::Index j = 0; j < azimuths.cosines.size(); ++j) {
      mean += (azimuths.weights[j] * scattered(azimuths.cosines[j])).real();
    }
    sum += 0.5 * directions_->weight[i] * passing_(mu) * mean;
  }
  return sum;
}

double OnceScatteredBeam::density_times_radius(double r) const {
  const double thickness = medium_->thickness();
  const double extinction = medium_->extinction();
  const double scattering = extinction * medium_->medium().single_scattering_albedo();
  // Light at the angle x to the normal leaves after the distance r / sin(x), from the depth r / tan(x).
  const double first = std::isinf(thickness) ? 0.0 : std::atan2(r, thickness);
  const double last = std::acos(critical_);
  if (!(first < last)) {
    return 0.0;
  }
  const double finest = std::max(first, std::min(0.02 * extinction * r, 0.1));
  const Nodes angles = graded(first, last, std::max(finest, 1e-7), critical_ > 0.0);
  double sum = 0.0;
  for (std::size_t k = 0; k < angles.place.size(); ++k) {
    const double sine = std::sin(angles.place[k]);
    const double mu = std::cos(angles.place[k]);
    const double depth = r * mu / sine;
    double beam = beam_.away * std::exp(-extinction * depth) * medium_->phase().evaluate(-mu);
    if (beam_.towards > 0.0 && !std::isinf(thickness)) {
      beam += beam_.towards * std::exp(-extinction * (thickness - depth)) * medium_->phase().evaluate(mu);
    }
    sum += angles.weight[k] * mu * beam * std::exp(-extinction * r / sine) * passing_(mu);
  }
  return scattering / (4.0 * pi) * sum;
}

double OnceScatteredBeam::moment(int power, double within) const {
  // Light from a farther distance is attenuated by at least exp(-40).
  const double end = std::min(within, 40.0 / medium_->extinction());
  if (!(end > 0.0)) {
    return 0.0;
  }
  const Nodes radii = graded(0.0, end, 1e-4 * end, false);
  double sum = 0.0;
  for (std::size_t k = 0; k < radii.place.size(); ++k) {
    sum += radii.weight[k] * std::pow(radii.place[k], power) * density_times_radius(radii.place[k]);
  }
  return 2.0 * pi * sum;
}

}  // namespace lamina
