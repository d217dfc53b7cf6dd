// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/facet_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

constexpr int kMostPoints = 256;
constexpr std::size_t kMostCuts = 24;

/// Gauss-Legendre rules on (0, 1) by number of points, computed on first use.
const Quadrature& gauss(int points) {
  static std::array<std::once_flag, kMostPoints> made;
  static std::array<std::unique_ptr<const Quadrature>, kMostPoints> rules;
  const auto k = static_cast<std::size_t>(std::clamp(points, 1, kMostPoints)) - 1;
  std::call_once(made[k], [k] { rules[k] = std::make_unique<const Quadrature>(static_cast<int>(k) + 1); });
  return *rules[k];
}

/// A point of (0, 1), mapped so that points are denser towards ends where the integrand has a square root.
struct Graded {
  double at;
  double slope = 1.0;

  Graded(double t, bool low, bool high) : at(t) {
    if (low && high) {
      at = t * t * (3.0 - 2.0 * t);
      slope = 6.0 * t * (1.0 - t);
    } else if (low) {
      at = t * t;
      slope = 2.0 * t;
    } else if (high) {
      at = t * (2.0 - t);
      slope = 2.0 * (1.0 - t);
    }
  }
};

double sine(double cosine) { return std::sqrt(std::max(0.0, 1.0 - cosine * cosine)); }

/// Fresnel reflectance; `ratio` = index on the other side / index on the ray's side.
double reflectance_between(double cosine, double refracted, double ratio) {
  const double s = (cosine - ratio * refracted) / (cosine + ratio * refracted);
  const double p = (ratio * cosine - refracted) / (ratio * cosine + refracted);
  return 0.5 * (s * s + p * p);
}

}  // namespace

void Rays::add(double flux, double cosine, double x, double y) {
  const double across = std::sqrt(x * x + y * y);
  share.push_back(flux);
  mu.push_back(std::min(cosine, 1.0));
  azimuth.push_back(across > 0.0 ? -x / across : 1.0);
}

FacetRays::FacetRays(const Facets& facets, FacetOptics optics, Pieces pieces)
    : FacetRays(facets, std::function<double(double)>(), std::move(pieces)) {
  optics_ = std::move(optics);
  ratio_ = optics_.ratio();
  critical_ = ratio_ < 1.0 ? sine(ratio_) : 0.0;
}

FacetRays::FacetRays(const Facets& facets, std::function<double(double)> reflectance, Pieces pieces)
    : facets_(facets), reflectance_(std::move(reflectance)), pieces_(std::move(pieces)) {
  constexpr double kBeckmannEnd = 4.8;  // exp(-4.8^2) = 1e-10
  steepest_ = facets.distribution == Facets::Distribution::kGgx ? 0.5 * pi : std::atan(kBeckmannEnd * facets.alpha);
}

FacetRays::FacetRays(const Base& base, double ior_above, Pieces pieces)
    : FacetRays(base.facets, base.facet_reflectance(ior_above), std::move(pieces)) {
  measured_ = base.measured;
}

/// Angles of the circles that touch a division in the plane of incidence, ascending.
std::vector<double> FacetRays::divisions(double mu) const {
  const double incident = std::acos(mu);
  std::vector<double> all{0.5 * pi - incident};
  for (const double end : pieces_.here) {
    const double leaving = std::acos(end);
    all.insert(all.end(), {0.5 * std::abs(leaving - incident), 0.5 * (leaving + incident)});
  }
  if (critical_ > 0.0) {
    const double total = std::acos(critical_);
    all.insert(all.end(), {std::abs(total - incident), incident + total});
  }
  if (ratio_ > 0.0) {
    for (const double end : pieces_.beyond) {
      // A facet tilted by a refracts so that sin(leaving - a) = sin(incident - a) / ratio.
      for (const double leaving : {sine(end), -sine(end)}) {
        all.push_back(std::abs(std::atan((leaving - sine(mu) / ratio_) / (end - mu / ratio_))));
      }
    }
  }
  std::erase_if(all, [&](double angle) { return !(angle > 0.0 && angle < steepest_); });
  all.push_back(steepest_);
  std::sort(all.begin(), all.end());
  return all;
}

void FacetRays::scatter(double mu, Rays& reflected, Rays& transmitted) const {
  for (Rays* rays : {&reflected, &transmitted}) {
    rays->share.clear();
    rays->mu.clear();
    rays->azimuth.clear();
  }
  // angle = alpha sinh(x): uniform steps across the lobe, geometric steps in its tail.
  constexpr double kPerLobe = 6.0;
  constexpr double kPerWave = 0.5;
  const Incident in{mu, sine(mu), facets_.lambda(mu)};
  double low = 0.0;
  for (const double high : divisions(mu)) {
    const double x0 = std::asinh(low / facets_.alpha);
    const double x1 = std::asinh(high / facets_.alpha);
    if (x1 - x0 > 1e-12) {
      const int points = 2 + static_cast<int>(std::ceil(kPerLobe * pieces_.density * (x1 - x0) +
                                                        kPerWave * pieces_.degree * (high - low)));
      const Quadrature& rule = gauss(points);
      for (Eigen::Index k = 0; k < rule.mu.size(); ++k) {
        // Where circles touch a division, sums over circles begin or end with a square root.
        const Graded point(rule.mu[k], low > 0.0, high < steepest_);
        const double x = x0 + (x1 - x0) * point.at;
        const double step = (x1 - x0) * rule.weight[k] * point.slope;
        circle(in, facets_.alpha * std::sinh(x), step * facets_.alpha * std::cosh(x), reflected, transmitted);
      }
    }
    low = high;
  }
}

/// Scatters from all facets of one tilt; `weight` is the step of the angle.
void FacetRays::circle(const Incident& in, double angle, double weight, Rays& reflected, Rays& transmitted) const {
  const double mu = in.mu;
  const Tilt tilt{std::cos(angle), std::sin(angle)};
  const auto& [upright, flat] = tilt;
  const double mean = mu * upright;  // cosine between ray and facet: mean + swing cos(azimuth)
  const double swing = in.across * flat;
  // A measured base has values by ray, and half vectors are sampled: the solid angle of rays is 4 cos(ray, facet) times
  // that of half vectors. 2 is for the other side of the plane of incidence.
  const double density = (measured_ ? 8.0 : 2.0 * facets_.density(upright) / mu) * flat * weight;
  constexpr double kPerCircle = 5.0;
  constexpr double kPerWave = 1.0;
  // Outgoing azimuths cover the whole circle, and whole waves, only for tilts beyond the angle of incidence.
  const double around = std::min(1.0, flat / std::max(in.across, 1e-9));
  const double points = kPerCircle * pieces_.density + kPerWave * pieces_.degree * around;

  // Azimuths of divisions, from 0 to the last azimuth where a facet faces the ray.
  std::array<double, kMostCuts> cuts{};
  std::size_t count = 0;
  cuts[count++] = 0.0;
  const auto cut = [&](double cosine) {
    if (cosine > std::max(0.0, mean - swing) && cosine < mean + swing && count + 1 < kMostCuts) {
      const double added = std::acos(std::clamp((cosine - mean) / swing, -1.0, 1.0));
      std::size_t place = count++;
      for (; cuts[place - 1] > added; --place) {
        cuts[place] = cuts[place - 1];
      }
      cuts[place] = added;
    }
  };
  for (const double end : pieces_.here) {
    cut(0.5 * (mu + end) / upright);
  }
  if (critical_ > 0.0) {
    cut(critical_);
  }
  if (ratio_ > 0.0) {
    for (const double end : pieces_.beyond) {
      // cosine / ratio - refracted cosine = lift, see facet().
      const double lift = (mu / ratio_ - end) / upright;
      const double cosine = 0.5 * ratio_ * (lift * lift + 1.0 / (ratio_ * ratio_) - 1.0) / lift;
      if (cosine / ratio_ >= lift) {
        cut(cosine);
      }
    }
  }
  const bool turned = mean < swing;
  cuts[count++] = turned ? std::acos(std::max(-1.0, -mean / swing)) : pi;
  if (count == 2 && !turned) {
    // The integrand is smooth and periodic: use equal steps.
    const int steps = static_cast<int>(std::ceil(points));
    for (int k = 0; k < steps; ++k) {
      facet(in, tilt, pi * (k + 0.5) / steps, density * pi / steps, reflected, transmitted);
    }
    return;
  }
  for (std::size_t k = 1; k < count; ++k) {
    const double span = cuts[k] - cuts[k - 1];
    if (span < 1e-12) {
      continue;
    }
    const Quadrature& rule = gauss(2 + static_cast<int>(std::ceil(1.3 * points * span / pi)));
    for (Eigen::Index j = 0; j < rule.mu.size(); ++j) {
      // Transmitted light, and cosines in a less dense medium, end with a square root.
      const Graded point(rule.mu[j], k > 1, k + 1 < count);
      facet(in, tilt, cuts[k - 1] + span * point.at, density * span * rule.weight[j] * point.slope, reflected,
            transmitted);
    }
  }
}

/// Scatters from one facet; `azimuth` is relative to the ray.
void FacetRays::facet(const Incident& in, const Tilt& tilt, double azimuth, double weight, Rays& reflected,
                      Rays& transmitted) const {
  const auto& [mu, across, lambda] = in;
  const double x = tilt.flat * std::cos(azimuth);
  const double y = tilt.flat * std::sin(azimuth);
  const double z = tilt.upright;
  const double cosine = mu * z + across * x;
  if (!(cosine > 0.0)) {
    return;
  }
  const double up = 2.0 * cosine * z - mu;
  if (measured_) {
    if (up > 0.0) {
      reflected.add(weight * cosine * up * measured_->value(std::min(up, 1.0), mu, cosine), up,
                    2.0 * cosine * x - across, 2.0 * cosine * y);
    }
    return;
  }
  const double refracted2 = ratio_ > 0.0 ? 1.0 - (1.0 - cosine * cosine) / (ratio_ * ratio_) : -1.0;
  const double refracted = refracted2 > 0.0 ? std::sqrt(refracted2) : 0.0;
  double back = 1.0;
  if (ratio_ == 0.0) {
    back = reflectance_(cosine);
  } else if (optics_.film) {
    back = optics_.reflectance(cosine);
  } else if (refracted2 > 0.0) {
    back = reflectance_between(cosine, refracted, ratio_);
  }
  if (up > 0.0) {
    const double turn = facets_.turn();
    reflected.add(weight * cosine * back * facets_.masked(facets_.lambda(up), lambda), up,
                  turn * (2.0 * cosine * x - across), turn * 2.0 * cosine * y);
  }
  if (refracted2 > 0.0) {
    const double along = cosine / ratio_ - refracted;
    const double down = mu / ratio_ - along * z;
    if (down > 0.0) {
      const double passed = optics_.film ? optics_.transmittance(cosine) : 1.0 - back;
      transmitted.add(weight * cosine * passed * facets_.passed(facets_.lambda(down), lambda), down,
                      along * x - across / ratio_, along * y);
    }
  }
}

}  // namespace lamina
