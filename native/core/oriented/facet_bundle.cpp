// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/facet_bundle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "matter/fresnel.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {

using std::numbers::pi;

Heading Heading::of(double mu, double phi) {
  const double sine = std::sqrt(std::max(0.0, 1.0 - mu * mu));
  return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

double FacetOptics::reflectance(double cosine) const {
  return metal ? conductor_fresnel(cosine, *metal) : fresnel(cosine, beyond / here);
}

FacetBundle::FacetBundle(const Facets& facets, int fineness) : facets_(facets), circles_(fineness) {}

/// The facets that are visible from (x, y, z).
std::vector<FacetBundle::Normal> FacetBundle::normals(double x, double y, double z) const {
  const double c = std::cos(facets_.angle);
  const double s = std::sin(facets_.angle);
  const double along = facets_.alpha;
  const double across = facets_.across();
  // The direction as facets of width 1 see it.
  double u = along * (c * x + s * y);
  double v = across * (c * y - s * x);
  const double length = std::sqrt(u * u + v * v + z * z);
  u /= length;
  v /= length;
  const double w = z / length;
  std::vector<Normal> found;
  const auto add = [&](double a, double b, double upright, double weight) {
    const double p = along * a;
    const double q = across * b;
    const double norm = 1.0 / std::sqrt(p * p + q * q + upright * upright);
    found.push_back({norm * (c * p - s * q), norm * (s * p + c * q), norm * upright, weight});
  };
  const int around = 2 * circles_;
  found.reserve(static_cast<std::size_t>(circles_ * around));
  if (facets_.distribution == Facets::Distribution::kGgx) {
    // Facets of width 1 reflect light uniformly over a cap of the sphere (Dupuy and Benyoub 2023). Squares put more
    // points where facets are steep.
    const Quadrature rule(circles_);
    for (int k = 0; k < circles_; ++k) {
      const double height = (1.0 + w) * rule.mu[k] * rule.mu[k];
      const double up = height - w;
      const double sine = std::sqrt(std::max(0.0, 1.0 - up * up));
      for (int j = 0; j < around; ++j) {
        const double turn = 2.0 * pi * (j + 0.5) / around;
        add(sine * std::cos(turn) + u, sine * std::sin(turn) + v, height,
            2.0 * rule.mu[k] * rule.weight[k] / around);
      }
    }
    return found;
  }
  // Slopes along and across the ray; steeper ones are below rounding.
  constexpr double kSteepest = 5.5;
  const double sine = std::hypot(u, v);
  const double cos_ray = sine > 0.0 ? u / sine : 1.0;
  const double sin_ray = sine > 0.0 ? v / sine : 0.0;
  const Quadrature rule(around, -kSteepest, sine > 0.0 ? std::min(kSteepest, w / sine) : kSteepest);
  double sum = 0.0;
  for (int k = 0; k < around; ++k) {
    for (int j = 0; j < circles_; ++j) {
      const double first = rule.mu[k];
      const double second = kSteepest * (2.0 * (j + 0.5) / circles_ - 1.0);
      const double weight = rule.weight[k] * (w - first * sine) * std::exp(-first * first - second * second);
      add(-(cos_ray * first - sin_ray * second), -(sin_ray * first + cos_ray * second), 1.0, weight);
      sum += weight;
    }
  }
  for (Normal& one : found) {
    one.weight /= sum;
  }
  return found;
}

double FacetBundle::scatter(const Heading& in, const FacetOptics& optics, RayList& reflected,
                            RayList& transmitted) const {
  for (RayList* list : {&reflected, &transmitted}) {
    list->share.clear();
    list->ray.clear();
  }
  const double x = -in.x;
  const double y = -in.y;
  const double hidden = facets_.lambda(x, y, in.mu);
  const double ratio = optics.beyond / optics.here;
  double kept = 0.0;
  for (const Normal& h : normals(x, y, in.mu)) {
    const double cosine = std::min(1.0, x * h.x + y * h.y + in.mu * h.z);
    if (cosine <= 0.0) {
      continue;
    }
    const double fresnel = optics.reflectance(cosine);
    const double up = 2.0 * cosine * h.z - in.mu;
    if (up > 0.0) {
      const Heading out{2.0 * cosine * h.x - x, 2.0 * cosine * h.y - y, std::min(1.0, up)};
      const double shown = h.weight * (1.0 + hidden) * facets_.masked(hidden, facets_.lambda(out.x, out.y, out.mu));
      reflected.add(fresnel * shown, out);
      kept += (optics.metal ? 1.0 : fresnel) * shown;
    }
    const double refracted = 1.0 - (1.0 - cosine * cosine) / (ratio * ratio);
    if (optics.metal || refracted <= 0.0) {
      continue;
    }
    const double along = cosine / ratio - std::sqrt(refracted);
    const double down = in.mu / ratio - along * h.z;
    if (down > 0.0) {
      const Heading out{along * h.x - x / ratio, along * h.y - y / ratio, std::min(1.0, down)};
      const double shown = h.weight * (1.0 + hidden) * facets_.passed(hidden, facets_.lambda(out.x, out.y, out.mu));
      transmitted.add((1.0 - fresnel) * shown, out);
      kept += (1.0 - fresnel) * shown;
    }
  }
  return kept;
}

double facet_value(const Facets& facets, const FacetOptics& optics, const Heading& in, const Heading& out,
                   bool beyond) {
  const double hidden = facets.lambda(in.x, in.y, in.mu);
  const double unseen = facets.lambda(out.x, out.y, out.mu);
  // The half vector; light comes from (-in.x, -in.y, in.mu).
  const double scale = beyond ? -optics.beyond : optics.here;
  double x = -optics.here * in.x * (beyond ? -1.0 : 1.0) + scale * out.x;
  double y = -optics.here * in.y * (beyond ? -1.0 : 1.0) + scale * out.y;
  double z = beyond ? optics.beyond * out.mu - optics.here * in.mu : optics.here * (in.mu + out.mu);
  double length = std::sqrt(x * x + y * y + z * z);
  if (length == 0.0) {
    return 0.0;
  }
  length = z < 0.0 ? -length : length;
  x /= length;
  y /= length;
  z /= length;
  const double cosine = std::min(1.0, in.mu * z - in.x * x - in.y * y);
  if (!beyond) {
    return facets.density(x, y, std::min(1.0, z)) * optics.reflectance(cosine) * facets.masked(hidden, unseen) /
           (4.0 * in.mu * out.mu * optics.here * optics.here);
  }
  const double leaving = out.x * x + out.y * y - out.mu * z;
  if (!(cosine > 0.0 && leaving < 0.0)) {
    return 0.0;
  }
  return facets.density(x, y, std::min(1.0, z)) * (1.0 - optics.reflectance(cosine)) *
         facets.passed(hidden, unseen) * -cosine * leaving / (in.mu * out.mu * length * length);
}

}  // namespace lamina
