// SPDX-License-Identifier: GPL-3.0-or-later
#include "events/measured_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "events/facet_normals.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

constexpr double kCosine = 0.4;  // share of rays by Lambert's cosine
constexpr double kWider = 1.4;   // than the narrowest peak: a measured lobe may have a wider tail

Ray half_of(const Ray& view, const Ray& out) { return normalised({view.x + out.x, view.y + out.y, view.z + out.z}); }

}  // namespace

MeasuredScatter::MeasuredScatter(const Base& base, double ior_above) : measured_(base.measured), ior_(ior_above) {
  facets_.alpha = std::min(1.0, kWider * base.facets.alpha);
}

double MeasuredScatter::reflected(const Ray& view, const Ray& out, const Ray& half) const {
  return measured_->value(std::min(view.z, 1.0), std::min(out.z, 1.0), std::clamp(view.dot(half), 1e-6, 1.0));
}

double MeasuredScatter::value(const Ray& in, const Ray& out) const {
  const Ray view = -in;
  return view.z > 0.0 && out.z > 0.0 ? reflected(view, out, half_of(view, out)) / (ior_ * ior_) : 0.0;
}

ScatteringSurface::Outcome MeasuredScatter::sample(const Ray& in, Rng& rng) const {
  const Ray view = -in;
  const bool lambert = rng.uniform() < kCosine;
  const double u = rng.uniform();
  const double v = rng.uniform();
  Ray out;
  if (lambert) {
    out = lambert_ray(rng);
  } else {
    const Ray normal = visible_normal(facets_, view, u, v);
    out = mirrored_at(normal, in, in.dot(normal));
  }
  if (!(out.z > 0.0 && view.z > 0.0)) {
    return {out, 0.0};
  }
  const Ray half = half_of(view, out);
  // Of visible normals D G1 (view . normal) / view.z, over 4 (view . normal).
  const double facets = facets_.density(std::min(1.0, half.z)) / ((1.0 + facets_.lambda(view.z)) * 4.0 * view.z);
  const double density = kCosine * out.z / pi + (1.0 - kCosine) * facets;
  return {out, reflected(view, out, half) * out.z / density};
}

ScatteringSurface::Outcome MeasuredScatter::sample_once(const Ray& in, bool reflects, Rng& rng) const {
  return reflects ? sample(in, rng) : Outcome{in, 0.0};
}

}  // namespace lamina
