// SPDX-License-Identifier: GPL-3.0-or-later
#include "events/facet_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "events/facet_normals.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

}  // namespace

FacetScatter::FacetScatter(const Facets& facets, const FacetOptics& above)
    : facets_(facets),
      above_(above),
      below_(above.turned()),
      metal_(above.is_opaque()),
      compensate_(facets.compensate) {
  if (!compensate_) {
    return;
  }
  losses_[0] = loss_on(false);
  whole_loss_ = above_.here * above_.here * losses_[0].mean;
  if (metal_) {
    const double mean = above_.mean_reflectance();
    compensation_ = mean * mean * (1.0 - losses_[0].mean) / (1.0 - mean * losses_[0].mean);
  } else {
    losses_[1] = loss_on(true);
    whole_loss_ += below_.here * below_.here * losses_[1].mean;
  }
  compensate_ = whole_loss_ > 0.0;
}

double FacetScatter::Loss::operator()(double mu, double twice) const {
  double sum = interpolated(waves.front(), mu);
  double before = 1.0;
  double wave = twice;  // Chebyshev's recurrence
  for (std::size_t k = 1; k < waves.size(); ++k) {
    sum += wave * interpolated(waves[k], mu);
    const double next = 2.0 * twice * wave - before;
    before = wave;
    wave = next;
  }
  return std::clamp(sum, 0.0, largest);
}

double FacetScatter::Loss::interpolated(const Row& row, double mu) {
  const double x = std::sqrt(mu) * kKnots;
  const int first = std::clamp(static_cast<int>(x) - 1, 0, kKnots - 3);
  double sum = 0.0;
  for (int k = first; k <= first + 3; ++k) {
    double weight = row[static_cast<std::size_t>(k)];
    for (int other = first; other <= first + 3; ++other) {
      weight *= other == k ? 1.0 : (x - other) / (k - other);
    }
    sum += weight;
  }
  return sum;
}

double FacetScatter::lost(bool below, const Ray& ray) const {
  const Loss& loss = losses_[below ? 1 : 0];
  if (!facets_.is_oriented()) {
    return loss.mean_at(std::abs(ray.z));
  }
  const double square = ray.x * ray.x + ray.y * ray.y;
  const double twice = std::cos(2.0 * facets_.angle) * (ray.x * ray.x - ray.y * ray.y) +
                       std::sin(2.0 * facets_.angle) * 2.0 * ray.x * ray.y;
  return loss(std::abs(ray.z), square > 0.0 ? std::clamp(twice / square, -1.0, 1.0) : 1.0);
}

double FacetScatter::loss_at(const std::vector<VisibleFacet>& facets, bool below, double mu, double azimuth) const {
  const Ray view{sine_of(mu) * std::cos(azimuth), sine_of(mu) * std::sin(azimuth), mu};
  const double hidden = lambda_of(view);
  double kept = 0.0;
  for (const VisibleFacet& facet : facets) {
    const Ray normal = visible_normal(facets_, view, facet.u, facet.v);
    const double back = reflected(view, normal, hidden).kept;
    if (metal_) {
      kept += facet.weight * back;
      continue;
    }
    // Follow reflection and refraction, each with its share, instead of choosing one.
    const double share = optics(below).reflectance(std::min(1.0, view.dot(normal)));
    const double passed = refracted(view, normal, hidden, optics(below).ratio()).kept;
    kept += facet.weight * (share * back + (1.0 - share) * passed);
  }
  return std::max(0.0, 1.0 - kept);
}

FacetScatter::Loss FacetScatter::loss_on(bool below) const {
  constexpr double kGrazing = 1e-4;  // replaces a cosine of 0
  constexpr std::size_t kAzimuths = 8;
  const bool oriented = facets_.is_oriented();
  const std::size_t azimuths = oriented ? kAzimuths : 1;
  const auto& facets = oriented ? all_visible_facets(facets_.distribution) : visible_facets(facets_.distribution);
  Loss loss;
  loss.waves.assign(azimuths, {});
  for (int knot = 0; knot <= Loss::kKnots; ++knot) {
    const double root = static_cast<double>(knot) / Loss::kKnots;
    const double mu = std::max(kGrazing, root * root);
    for (std::size_t j = 0; j < azimuths; ++j) {
      const double turn = oriented ? 0.5 * pi * (static_cast<double>(j) + 0.5) / kAzimuths : 0.0;
      const double one = loss_at(facets, below, mu, oriented ? facets_.angle + turn : 0.0);
      loss.largest = std::max(loss.largest, one);
      for (std::size_t k = 0; k < azimuths; ++k) {
        const double part = (k == 0 ? 1.0 : 2.0) / static_cast<double>(azimuths);
        loss.waves[k][static_cast<std::size_t>(knot)] += part * std::cos(2.0 * static_cast<double>(k) * turn) * one;
      }
    }
  }
  // int 2 mu e dmu = int 4 t^3 e dt with t = sqrt(mu), a polynomial between knots.
  static const Quadrature rule(4);
  for (int knot = 0; knot < Loss::kKnots; ++knot) {
    for (Eigen::Index i = 0; i < rule.mu.size(); ++i) {
      const double t = (knot + rule.mu[i]) / Loss::kKnots;
      loss.mean += rule.weight[i] / Loss::kKnots * 4.0 * t * t * t * loss.mean_at(t * t);
    }
  }
  return loss;
}

double FacetScatter::density_of(const Ray& normal) const {
  const double z = std::min(1.0, normal.z);
  return facets_.is_oriented() ? facets_.density(normal.x, normal.y, z) : facets_.density(z);
}

double FacetScatter::lambda_of(const Ray& ray) const {
  const double mu = std::abs(ray.z);
  return facets_.is_oriented() ? facets_.lambda(ray.x, ray.y, mu) : facets_.lambda(mu);
}

double FacetScatter::facet_value(const Ray& view, const Ray& out, bool from_below) const {
  const double here = ior_of(from_below);
  const double there = ior_of(!from_below);
  if (out.z > 0.0) {
    const double turn = facets_.turn();
    const Ray half = normalised({view.x + turn * out.x, view.y + turn * out.y, view.z + out.z});
    const double fresnel = optics(from_below).reflectance(std::min(1.0, view.dot(half)));
    return density_of(half) * fresnel * facets_.masked(lambda_of(view), lambda_of(out)) /
           (4.0 * view.z * out.z * here * here);
  }
  if (metal_) {
    return 0.0;
  }
  Ray half{-here * view.x - there * out.x, -here * view.y - there * out.y, -here * view.z - there * out.z};
  const double length = std::sqrt(half.dot(half));
  const double turn = (half.z > 0.0 ? 1.0 : -1.0) / length;
  half = {half.x * turn, half.y * turn, half.z * turn};
  const double seen = view.dot(half);
  const double left = out.dot(half);
  if (!(seen > 0.0 && left < 0.0)) {
    return 0.0;
  }
  return density_of(half) * optics(from_below).transmittance(std::min(1.0, seen)) *
         facets_.passed(lambda_of(view), lambda_of(out)) * -seen * left / (view.z * -out.z * length * length);
}

FacetScatter::ByFacet FacetScatter::reflected(const Ray& view, const Ray& normal, double hidden) const {
  const double seen = view.dot(normal);
  if (seen <= 0.0) {
    return {view, 0.0};
  }
  const double shown = 1.0 / (1.0 + hidden);
  const double turn = facets_.turn();
  const Ray out{turn * (2.0 * seen * normal.x - view.x), turn * (2.0 * seen * normal.y - view.y),
                2.0 * seen * normal.z - view.z};
  return {out, out.z > 0.0 ? facets_.masked(hidden, lambda_of(out)) / shown : 0.0};
}

FacetScatter::ByFacet FacetScatter::refracted(const Ray& view, const Ray& normal, double hidden, double ratio) const {
  const double seen = view.dot(normal);
  const double refracted2 = 1.0 - (1.0 - seen * seen) / (ratio * ratio);
  if (seen <= 0.0 || refracted2 <= 0.0) {
    return {view, 0.0};
  }
  const double shown = 1.0 / (1.0 + hidden);
  const double along = seen / ratio - std::sqrt(refracted2);
  const Ray out{along * normal.x - view.x / ratio, along * normal.y - view.y / ratio,
                along * normal.z - view.z / ratio};
  return {out, out.z < 0.0 ? facets_.passed(hidden, lambda_of(out)) / shown : 0.0};
}

double FacetScatter::value(const Ray& in, const Ray& out) const {
  const bool from_below = in.z > 0.0;
  const bool to_below = out.z < 0.0;
  const Ray view = from_below ? -in.mirrored() : -in;
  double value = value_once(in, out);
  if (compensate_ && !(metal_ && to_below)) {
    value += compensation_ * lost(from_below, view) * lost(to_below, out) / (pi * whole_loss_);
  }
  return value;
}

double FacetScatter::value_once(const Ray& in, const Ray& out) const {
  const bool from_below = in.z > 0.0;
  return facet_value(from_below ? -in.mirrored() : -in, from_below ? out.mirrored() : out, from_below);
}

FacetScatter::Outcome FacetScatter::sample_once(const Ray& in, bool reflects, Rng& rng) const {
  const bool from_below = in.z > 0.0;
  const Ray view = from_below ? -in.mirrored() : -in;
  const FacetOptics& here = optics(from_below);
  const double u = rng.uniform();
  const double v = rng.uniform();
  const Ray normal = visible_normal(facets_, view, u, v);
  const double hidden = lambda_of(view);
  const ByFacet facet =
      reflects || metal_ ? reflected(view, normal, hidden) : refracted(view, normal, hidden, here.ratio());
  const double seen = std::clamp(view.dot(normal), 0.0, 1.0);
  const double share = reflects ? here.reflectance(seen) : here.transmittance(seen);
  return {from_below ? facet.ray.mirrored() : facet.ray, share * facet.kept};
}

FacetScatter::Outcome FacetScatter::sample(const Ray& in, Rng& rng) const {
  const bool from_below = in.z > 0.0;
  const Ray view = from_below ? -in.mirrored() : -in;
  const FacetOptics& here = optics(from_below);
  const double choice = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  const Ray normal = visible_normal(facets_, view, u, v);
  const double hidden = lambda_of(view);
  const double seen = std::clamp(view.dot(normal), 0.0, 1.0);
  const double share = here.reflectance(seen);
  const bool passes = !metal_ && choice >= share;
  const ByFacet facet = passes ? refracted(view, normal, hidden, here.ratio()) : reflected(view, normal, hidden);
  // Metals always reflect; their reflectance goes into the weight, as does what a film absorbs.
  const double weight = metal_ ? share : passes && here.film ? here.transmittance(seen) / (1.0 - share) : 1.0;
  if (!compensate_) {
    return {from_below ? facet.ray.mirrored() : facet.ray, weight * facet.kept};
  }
  // What this facet loses is compensated, not the tabulated mean: a dielectric then loses nothing, whatever the table's
  // errors.
  if (rng.uniform() < facet.kept) {
    return {from_below ? facet.ray.mirrored() : facet.ray, weight};
  }
  const double above = above_.here * above_.here * losses_[0].mean / whole_loss_;
  const std::size_t side = rng.uniform() < above ? 0 : 1;
  // Rejection: the density of directions is the cosine times the loss, so that all weights are equal.
  Ray out = lambert_ray(rng);
  while (rng.uniform() * losses_[side].largest >= lost(side == 1, out)) {
    out = lambert_ray(rng);
  }
  return {side == 0 ? out : out.mirrored(), compensation_};
}

}  // namespace lamina
