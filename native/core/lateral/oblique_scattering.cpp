// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/oblique_scattering.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "lateral/once_scattered_beam.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using std::numbers::pi;
using Complex = std::complex<double>;

/// cos(m phi) from cos(phi).
Complex cosine_of_multiple(std::size_t m, Complex cosine) {
  Complex before = 1.0;
  Complex now = cosine;
  if (m == 0) {
    return before;
  }
  for (std::size_t k = 1; k < m; ++k) {
    const Complex next = 2.0 * cosine * now - before;
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

ObliqueScattering::ObliqueScattering(const LateralMedium& medium, const Directions& directions,
                                     std::vector<BeamWay> ways, std::function<double(double mu)> passing,
                                     double critical)
    : medium_(&medium),
      directions_(&directions),
      ways_(std::move(ways)),
      passing_(std::move(passing)),
      critical_(critical),
      mu_(directions.mu[directions.live]),
      sine_(std::sqrt(1.0 - mu_ * mu_)) {}

/// The truncated phase function of light that leaves at the cosine `mu`.
double ObliqueScattering::phase(double mu, bool away, double azimuth_cosine) const {
  const double cosine = (away ? -mu_ : mu_) * mu + sine_ * std::sqrt(1.0 - mu * mu) * azimuth_cosine;
  return truncated_phase(medium_->medium(), std::clamp(cosine, -1.0, 1.0));
}

double ObliqueScattering::discretised(double q, const AzimuthRule& azimuths) const {
  const TruncatedMedium& medium = medium_->medium();
  const double slant = q / medium_->extinction();
  const double tau = medium.tau;
  const auto orders =
      static_cast<std::size_t>(std::min<Index>(azimuths.orders(), static_cast<Index>(medium.moments.size())));
  const std::size_t samples = 2 * medium.moments.size();
  // Both azimuths of a pair for the beam; one of each pair for scattered light, by symmetry.
  struct Azimuth {
    Complex cosine;
    Complex weight;
  };
  std::vector<Azimuth> of_light;
  std::vector<Azimuth> of_beam;
  for (Index j = 0; j < azimuths.cosines.size(); ++j) {
    of_light.push_back({azimuths.cosines[j], azimuths.weights[j]});
    of_beam.push_back({azimuths.cosines[j], 0.5 * azimuths.weights[j]});
    of_beam.push_back({-std::conj(azimuths.cosines[j]), 0.5 * std::conj(azimuths.weights[j])});
  }
  if (azimuths.count == 1) {
    of_light.push_back({0.0, 1.0});
    of_beam.push_back({0.0, 1.0});
  }
  std::vector<std::vector<Complex>> light_orders(orders);
  std::vector<std::vector<Complex>> beam_orders(orders);
  for (std::size_t m = 0; m < orders; ++m) {
    for (const Azimuth& one : of_light) {
      light_orders[m].push_back(one.weight * cosine_of_multiple(m, one.cosine));
    }
    for (const Azimuth& one : of_beam) {
      beam_orders[m].push_back(one.weight * cosine_of_multiple(m, one.cosine));
    }
  }
  double sum = 0.0;
  for (Index i = 0; i < directions_->live; ++i) {
    const double mu = directions_->mu[i];
    if (mu <= critical_) {
      continue;
    }
    const double sine = std::sqrt(1.0 - mu * mu);
    double flux = 0.0;
    for (const bool away : {true, false}) {
      // Azimuth orders of the phase function, exact for its moments
      std::vector<double> phases(orders, 0.0);
      for (std::size_t k = 0; k < samples; ++k) {
        const double x = (static_cast<double>(k) + 0.5) * pi / static_cast<double>(samples);
        const double value = phase(mu, away, std::cos(x)) / static_cast<double>(samples);
        for (std::size_t m = 0; m < orders; ++m) {
          phases[m] += (m == 0 ? 1.0 : 2.0) * value * std::cos(static_cast<double>(m) * x);
        }
      }
      for (std::size_t b = 0; b < of_beam.size(); ++b) {
        Complex wave = 0.0;
        for (const BeamWay& way : ways_) {
          wave += way.away == away ? way.flux * std::exp(Complex(0.0, -q * way.start) * of_beam[b].cosine) : 0.0;
        }
        const Complex beam = (1.0 + Complex(0.0, slant * sine_) * of_beam[b].cosine) / mu_;
        for (std::size_t a = 0; a < of_light.size(); ++a) {
          const Complex rate = (1.0 + Complex(0.0, slant * sine) * of_light[a].cosine) / mu;
          Complex products = 0.0;
          for (std::size_t m = 0; m < orders; ++m) {
            products += phases[m] * light_orders[m][a] * beam_orders[m][b];
          }
          flux += (products * wave * once_attenuated(rate, beam, tau, away)).real();
        }
      }
    }
    sum += 0.5 * directions_->weight[i] * passing_(mu) * flux;
  }
  return sum * medium.albedo / mu_;
}

double ObliqueScattering::farthest() const {
  constexpr double kFaintest = 40.0;  // optical length
  double start = 0.0;
  for (const BeamWay& way : ways_) {
    start = std::max(start, way.start);
  }
  return start + 2.0 * kFaintest / medium_->extinction();
}

FluxByDistance ObliqueScattering::by_distance() const {
  constexpr double kScale = 0.1;  // mean free paths
  constexpr int kPoints = 1 << 14;
  constexpr std::size_t kAzimuths = 48;
  // A lattice of cosines and depths of low discrepancy (Roberts 2018).
  constexpr double kFirst = 0.7548776662466927;
  constexpr double kSecond = 0.5698402909980532;
  std::array<double, kAzimuths> middles{};  // cosines
  std::array<double, kAzimuths> ends{};
  for (std::size_t k = 0; k < kAzimuths; ++k) {
    middles[k] = std::cos(pi * (static_cast<double>(k) + 0.5) / kAzimuths);
    ends[k] = std::cos(pi * (static_cast<double>(k) + 1.0) / kAzimuths);
  }
  const double extinction = medium_->extinction();
  const double thickness = medium_->thickness();
  const bool endless = std::isinf(thickness);
  FluxByDistance found(kScale / extinction, farthest());
  for (int point = 0; point < kPoints; ++point) {
    const double mu = critical_ + (1.0 - critical_) * std::fmod(0.5 + kFirst * point, 1.0);
    const double within = endless ? 1.0 : -std::expm1(-extinction * thickness / mu);
    // The depth below the face, by the attenuation of the scattered light
    const double depth = -std::log1p(-within * std::fmod(0.5 + kSecond * point, 1.0)) * mu / extinction;
    const double aside = depth * std::sqrt(1.0 - mu * mu) / mu;
    const double light = mu * within * passing_(mu) / kAzimuths;
    for (const bool away : {true, false}) {
      std::array<double, kAzimuths> phases{};
      bool known = false;
      for (const BeamWay& way : ways_) {
        if (way.away != away) {
          continue;
        }
        if (!known) {
          std::ranges::transform(middles, phases.begin(), [&](double cosine) { return phase(mu, away, cosine); });
          known = true;
        }
        const double run = away ? depth : thickness - depth;
        const double beam = way.start + run * sine_ / mu_;
        const double flux = light * way.flux * std::exp(-extinction * run / mu_);
        double last = beam + aside;
        for (std::size_t k = 0; k < kAzimuths; ++k) {
          const double square = beam * beam + aside * aside + 2.0 * beam * aside * ends[k];
          const double next = std::sqrt(std::max(0.0, square));
          found.add(std::min(last, next), std::max(last, next), flux * phases[k]);
          last = next;
        }
      }
    }
  }
  found.normalise(discretised(0.0, AzimuthRule::mean()));
  return found;
}

}  // namespace lamina
