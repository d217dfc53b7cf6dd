// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/facet_albedo.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "matter/dielectric_rise.hpp"
#include "matter/microfacet.hpp"
#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

constexpr int kAlbedoEntries = 32;
constexpr int kRiseEntries = 16;
constexpr double kLeast = 1e-4;  // Cycles computes the entries at 0 for this roughness and cosine

/// Averages over the facets that are visible from a direction of cosine `mu`, by the map of the unit disk to visible
/// normals (Heitz 2018). `of` takes the cosine between ray and facet, and the cosine of the reflected ray; rays below
/// the horizon count as 0.
double visible_mean(double alpha, double mu, const std::function<double(double, double)>& of) {
  static const Quadrature rule(40);
  const double across = std::sqrt(1.0 - mu * mu);
  const double length = std::hypot(alpha * across, mu);
  const double stretched_x = alpha * across / length;
  const double stretched_z = mu / length;
  const double share = 0.5 * (1.0 + stretched_z);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < rule.mu.size(); ++k) {
    // Equal areas of the disk: radius^2 is uniform.
    const double radius = std::sqrt(rule.mu[k]);
    for (Eigen::Index j = 0; j < rule.mu.size(); ++j) {
      // The disk is symmetric, so half of its azimuths are enough. The first axis is across the plane of incidence.
      const double azimuth = std::numbers::pi * (rule.mu[j] - 0.5);
      const double first = radius * std::cos(azimuth);
      const double upper = std::sqrt(std::max(0.0, 1.0 - first * first));
      const double second = (1.0 - share) * upper + share * radius * std::sin(azimuth);
      const double third = std::sqrt(std::max(0.0, 1.0 - first * first - second * second));
      // From the frame about the stretched direction back to the surface: t2 = (-stretched_z, 0, stretched_x).
      const double x = alpha * (third * stretched_x - second * stretched_z);
      const double y = alpha * first;
      const double z = std::max(0.0, third * stretched_z + second * stretched_x);
      const double norm = std::sqrt(x * x + y * y + z * z);
      const double cosine = (across * x + mu * z) / norm;
      const double up = 2.0 * cosine * z / norm - mu;
      if (cosine > 0.0 && up > 0.0) {
        sum += rule.weight[k] * rule.weight[j] * of(cosine, up);
      }
    }
  }
  return sum;
}

double entry(int index, int entries) { return std::clamp(static_cast<double>(index) / (entries - 1), kLeast, 1.0); }

/// Calls body(index, share) for the two entries around `place` in [0, 1].
template <typename Body>
void around(double place, int entries, const Body& body) {
  const double x = std::clamp(place, 0.0, 1.0) * (entries - 1);
  const int low = std::min(static_cast<int>(x), entries - 1);
  body(low, 1.0 - (x - low));
  if (x > low) {
    body(low + 1, x - low);
  }
}

/// A row of the mean of `rise`, a function of the cosine between ray and facet, between two roughnesses.
CosineRows rise_row(double roughness, const std::function<double(double)>& rise) {
  CosineRows row{std::vector<double>(kRiseEntries, 0.0)};
  around(roughness, kRiseEntries, [&](int index, double share) {
    const double rough = entry(index, kRiseEntries);
    for (int k = 0; k < kRiseEntries; ++k) {
      row.values[static_cast<std::size_t>(k)] +=
          share * visible_mean(rough * rough, entry(k, kRiseEntries), [&](double c, double) { return rise(c); });
    }
  });
  return row;
}

}  // namespace

double CosineRows::at(double mu) const {
  double sum = 0.0;
  around(mu, static_cast<int>(values.size()),
         [&](int index, double share) { sum += share * values[static_cast<std::size_t>(index)]; });
  return sum;
}

FacetAlbedo facet_albedo(double roughness) {
  static const Quadrature rule(24);
  FacetAlbedo found{{std::vector<double>(kAlbedoEntries, 0.0)}, 0.0};
  around(roughness, kAlbedoEntries, [&](int index, double share) {
    const double rough = entry(index, kAlbedoEntries);
    const Facets facets{.alpha = rough * rough};
    const auto albedo = [&](double mu) {
      const double own = facets.lambda(mu);
      return visible_mean(facets.alpha, mu,
                          [&](double, double up) { return (1.0 + own) * facets.masked(own, facets.lambda(up)); });
    };
    for (int k = 0; k < kAlbedoEntries; ++k) {
      found.directional.values[static_cast<std::size_t>(k)] += share * albedo(entry(k, kAlbedoEntries));
    }
    for (Eigen::Index k = 0; k < rule.mu.size(); ++k) {
      found.mean += share * 2.0 * rule.mu[k] * rule.weight[k] * albedo(rule.mu[k]);
    }
  });
  return found;
}

CosineRows fresnel_rise(double roughness, double eta) {
  CosineRows row{std::vector<double>(kRiseEntries, 0.0)};
  // The entries are uniform in the fourth root of F0, the reflectance at normal incidence.
  around(std::sqrt(std::abs((eta - 1.0) / (eta + 1.0))), kRiseEntries, [&](int index, double share) {
    const double root = std::clamp(static_cast<double>(index) / (kRiseEntries - 1), kLeast, 0.99);
    const double near = index_from_f0(root * root * root * root);
    const CosineRows one = rise_row(roughness, [&](double c) { return dielectric_rise(c, near); });
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      row.values[k] += share * one.values[k];
    }
  });
  return row;
}

CosineRows schlick_rise(double roughness) {
  return rise_row(roughness, [](double c) { return std::pow(1.0 - c, 5.0); });
}

CosineRows facet_share(double roughness, const std::function<double(double)>& reflectance) {
  constexpr int kEntries = 65;
  const Facets facets{.alpha = std::max(kLeast, roughness * roughness)};
  CosineRows row;
  for (int k = 0; k < kEntries; ++k) {
    const double root = entry(k, kEntries);
    const double mu = root * root;
    const double own = facets.lambda(mu);
    const double albedo = visible_mean(facets.alpha, mu, [&](double cosine, double up) {
      return reflectance(cosine) * (1.0 + own) * facets.masked(own, facets.lambda(up));
    });
    row.values.push_back(albedo / reflectance(mu));
  }
  return row;
}

}  // namespace lamina
