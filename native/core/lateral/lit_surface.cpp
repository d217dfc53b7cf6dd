// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/lit_surface.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "matter/fresnel.hpp"
#include "numeric/bessel.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

/// The mean of the wave over azimuths; `phase` is the lateral frequency times the displacement.
double mean_wave(double phase, const AzimuthRule& azimuths) {
  if (azimuths.count == 1) {
    return 1.0;
  }
  double mean = 0.0;
  for (Eigen::Index j = 0; j < azimuths.cosines.size(); ++j) {
    mean += (azimuths.weights[j] * std::exp(std::complex<double>(0.0, -phase) * azimuths.cosines[j])).real();
  }
  return mean;
}

/// A function of the cosine between its values at nodes, which may have any order, and constant beyond.
double interpolated(const Eigen::VectorXd& nodes, const Eigen::VectorXd& values, double mu) {
  Eigen::Index below = -1;
  Eigen::Index above = -1;
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    if (nodes[i] <= mu && (below < 0 || nodes[i] > nodes[below])) {
      below = i;
    }
    if (nodes[i] >= mu && (above < 0 || nodes[i] < nodes[above])) {
      above = i;
    }
  }
  if (below < 0 || above < 0 || below == above) {
    return values[below < 0 ? above : below];
  }
  const double share = (mu - nodes[below]) / (nodes[above] - nodes[below]);
  return values[below] + share * (values[above] - values[below]);
}

}  // namespace

LitSurface::LitSurface(const Directions& directions, double beam, Spread spread, std::vector<Part> parts)
    : ior_(directions.ior),
      nodes_(directions.mu.head(directions.live)),
      beam_(beam),
      spread_(std::move(spread)),
      parts_(std::move(parts)),
      critical_{0.0, 1.0} {
  for (const Part& part : parts_) {
    if (part.thickness == 0.0 && part.passed.size() == 0 && part.ior < ior_) {
      critical_.push_back(refracted_cosine(0.0, part.ior, ior_));
    }
  }
  std::sort(critical_.begin(), critical_.end());
  for (Eigen::Index i = 0; i < directions.live; ++i) {
    discrete_.push_back({spread_.discrete[i], ray(directions.mu[i])});
  }
  if (spread_.returned == 0.0) {
    // All light together is that of the discretised stack, which keeps the flux of facets.
    const double whole = at(0.0);
    scale_ = whole > 0.0 ? discretised(0.0, AzimuthRule::mean()) / whole : 1.0;
  }
}

LitSurface::Ray LitSurface::ray(double mu) const {
  Ray ray;
  double flux = 1.0;
  double aside = 0.0;
  double ior = ior_;
  double cosine = mu;
  for (const Part& part : parts_) {
    if (part.thickness > 0.0) {
      flux *= std::exp(-part.extinction * part.thickness / cosine);
      aside += part.thickness * std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
      continue;
    }
    if (part.passed.size() > 0) {
      flux *= interpolated(nodes_, part.passed, mu);
      continue;
    }
    const double next = refracted_cosine(mu, ior_, part.ior);
    const double mirrored = next > 0.0 ? fresnel(cosine, next, ior, part.ior) : 1.0;
    ray.returning.push_back({flux * flux * mirrored, 2.0 * aside});
    if (spread_.echoed.size() > 0) {
      ray.leaving.push_back({flux * flux * mirrored * interpolated(nodes_, spread_.echoed, mu), 2.0 * aside});
    }
    if (!(next > 0.0)) {
      return ray;
    }
    flux *= 1.0 - mirrored;
    ior = part.ior;
    cosine = next;
  }
  if (spread_.echoed.size() == 0) {
    ray.leaving.push_back({flux, aside});
  }
  return ray;
}

double LitSurface::aside(double mu) const {
  const Ray found = ray(mu);
  double farthest = 0.0;
  for (const std::vector<Share>* shares : {&found.leaving, &found.returning}) {
    for (const Share& share : *shares) {
      farthest = std::max(farthest, share.aside);
    }
  }
  return farthest;
}

double LitSurface::exchanged(double leaving, double returning) const {
  return beam_ * leaving / (1.0 - spread_.returned * returning);
}

double LitSurface::discretised(double q, const AzimuthRule& azimuths) const {
  double leaving = 0.0;
  double returning = 0.0;
  for (const auto& [weight, ray] : discrete_) {
    for (const Share& share : ray.leaving) {
      leaving += weight * share.flux * mean_wave(q * share.aside, azimuths);
    }
    for (const Share& share : ray.returning) {
      returning += weight * share.flux * mean_wave(q * share.aside, azimuths);
    }
  }
  return exchanged(leaving, returning);
}

double LitSurface::at(double q) const {
  static const Quadrature rule(8);
  constexpr double kShortest = 1e-6;  // shortest piece, at the end of an interval
  constexpr double kPhase = 4.0;      // largest change of the phase of a wave within a piece
  constexpr double kLargest = 1e3;    // light beyond this phase is neglected: its waves cancel
  double leaving = 0.0;
  double returning = 0.0;
  const auto add = [&](double low, double high) {
    const double near = q * aside(high);
    if (near > kLargest) {
      return;
    }
    const double far = std::min(q * aside(std::max(low, 1e-9)), 4.0 * kLargest);
    const int count = 1 + static_cast<int>(std::abs(far - near) / kPhase);
    // Equal steps in 1 / mu are nearly equal steps of the lateral displacement.
    const double first = 1.0 / high;
    const double last = 1.0 / std::max(low, 1e-9);
    for (int k = 0; k < count; ++k) {
      const double from = count == 1 ? low : 1.0 / (first + (last - first) * (k + 1) / count);
      const double to = 1.0 / (first + (last - first) * k / count);
      for (Eigen::Index i = 0; i < rule.mu.size(); ++i) {
        const double mu = from + (to - from) * rule.mu[i];
        const double density = spread_.lobe(mu) + mu * interpolated(nodes_, spread_.matte, mu);
        const double weight = density * (to - from) * rule.weight[i];
        const Ray found = ray(mu);
        for (const Share& share : found.leaving) {
          leaving += weight * share.flux * bessel_j0(q * share.aside);
        }
        for (const Share& share : found.returning) {
          returning += weight * share.flux * bessel_j0(q * share.aside);
        }
      }
    }
  };
  for (std::size_t k = 0; k + 1 < critical_.size(); ++k) {
    const double middle = 0.5 * (critical_[k] + critical_[k + 1]);
    for (const double end : {critical_[k], critical_[k + 1]}) {
      double rest = middle - end;  // signed
      for (; std::abs(rest) > kShortest; rest *= 0.25) {
        add(std::min(end + rest, end + 0.25 * rest), std::max(end + rest, end + 0.25 * rest));
      }
      add(std::min(end, end + rest), std::max(end, end + rest));
    }
  }
  return scale_ * exchanged(leaving, returning);
}

}  // namespace lamina
