// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/microfacet.hpp"

#include <cmath>
#include <numbers>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using std::numbers::pi;

/// Fresnel reflectance for light at cosine c in a medium, against one of relative index `ratio`.
ArrayXd dielectric_fresnel(const ArrayXd& c, double ratio) {
  const ArrayXd refracted2 = 1.0 - (1.0 - c.square()) / (ratio * ratio);
  const ArrayXd t = refracted2.max(0.0).sqrt();
  const ArrayXd s = (c - ratio * t) / (c + ratio * t);
  const ArrayXd p = (ratio * c - t) / (ratio * c + t);
  return (refracted2 > 0.0).select(0.5 * (s.square() + p.square()), 1.0);
}

/// Born and Wolf, Principles of Optics, 13.2, in real arithmetic for whole arrays.
template <typename Array>  // an array of fixed size avoids heap memory
Array conductor_fresnel_array(const Array& c, std::complex<double> ratio) {
  const std::complex<double> square = ratio * ratio;
  const Array sine2 = 1.0 - c.square();
  const Array real = square.real() - sine2;
  const Array modulus = (real.square() + square.imag() * square.imag()).sqrt();
  const Array a = (0.5 * (modulus + real)).max(0.0).sqrt();
  const Array s = (modulus + c.square() - 2.0 * a * c) / (modulus + c.square() + 2.0 * a * c);
  const Array left = modulus * c.square() + sine2.square();
  const Array right = 2.0 * a * c * sine2;
  const Array p = s * (left - right) / (left + right);
  return 0.5 * (s + p);
}

ArrayXd reflectances(const FacetOptics& optics, const ArrayXd& c) {
  if (optics.film) {
    return c.unaryExpr([&](double one) { return optics.reflectance(one); });
  }
  if (optics.constant) {
    return ArrayXd::Constant(c.size(), *optics.constant);
  }
  return optics.metal ? conductor_fresnel_array(c, *optics.metal) : dielectric_fresnel(c, optics.ratio());
}

ArrayXd transmittances(const FacetOptics& optics, const ArrayXd& c) {
  if (optics.film) {
    return c.unaryExpr([&](double one) { return optics.transmittance(one); });
  }
  return 1.0 - dielectric_fresnel(c, optics.ratio());
}

double sine(double mu) { return std::sqrt(std::max(0.0, 1.0 - mu * mu)); }

ArrayXd sine(const ArrayXd& mu) { return (1.0 - mu.square()).max(0.0).sqrt(); }

/// Smith's Lambda of a direction from which facets of width 1 have the relative slope `slope`.
double lambda_at(Facets::Distribution distribution, double slope) {
  if (slope == 0.0) {
    return 0.0;
  }
  if (distribution == Facets::Distribution::kGgx) {
    return 0.5 * (std::sqrt(1.0 + slope * slope) - 1.0);
  }
  const double a = 1.0 / slope;
  return 0.5 * (std::erf(a) - 1.0 + std::exp(-a * a) / (a * std::sqrt(pi)));
}

/// The horizontal part of a direction along and across a tangent. Solves turn the facets to the angle 0.
Eigen::Vector2d in_tangents(double angle, double x, double y) {
  if (angle == 0.0) {
    return {x, y};
  }
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * x + s * y, c * y - s * x};
}

/// Masking between one direction and many, of reflected or of refracted light.
ArrayXd masking(const Facets& facets, double mu, const ArrayXd& others, bool refracted) {
  const double own = facets.lambda(mu);
  return others.unaryExpr([&](double other) {
    const double lambda = facets.lambda(other);
    return refracted ? facets.passed(own, lambda) : facets.masked(own, lambda);
  });
}

/// Single reflection between the directions of cosines mu_o and mu_i. `Mu` is a number, or an array as long as that of
/// the azimuths; `mask` is the masking, `fresnel` the reflectance by the cosine between ray and facet.
template <typename Mu, typename Fresnel>
ArrayXd reflection(const Facets& facets, double mu_o, const Mu& mu_i, const Mu& mask, const ArrayXd& cosines,
                   const Fresnel& fresnel) {
  // Both directions point away from the surface: forward light comes from the azimuth opposite to the viewer.
  const Mu sine_i = sine(mu_i);
  const ArrayXd between = mu_o * mu_i - facets.turn() * sine(mu_o) * sine_i * cosines;
  // Cosines of the half vector with either direction and with the normal.
  const ArrayXd ray = (0.5 * (1.0 + between)).max(1e-12).sqrt();
  const ArrayXd normal = ((mu_o + mu_i) / (2.0 * ray)).min(1.0);
  return facets.density(normal) * fresnel(ray) * (mask / (4.0 * mu_o * mu_i));
}

/// Single transmission between a direction of cosine `mu` where the light is and others beyond.
template <typename Mu>
ArrayXd transmission(const Facets& facets, const FacetOptics& optics, double mu, const Mu& mu_beyond, const Mu& mask,
                     const ArrayXd& cosines) {
  const double ior = optics.here;
  const double beyond = optics.beyond;
  const double s = sine(mu);
  const Mu s_beyond = sine(mu_beyond);
  // Light comes from (-s, 0, mu) and leaves to (s_beyond cos, s_beyond sin, -mu_beyond).
  // Their scalar product, and the half vector n w + n' w', turned towards the less dense medium.
  const ArrayXd between = -s * s_beyond * cosines - mu * mu_beyond;
  const double turn = ior > beyond ? 1.0 : -1.0;
  const ArrayXd length = (ior * ior + beyond * beyond + 2.0 * ior * beyond * between).max(1e-24).sqrt();
  const ArrayXd normal = turn * (ior * mu - beyond * mu_beyond) / length;
  const ArrayXd ray = turn * (ior + beyond * between) / length;
  const ArrayXd ray_beyond = turn * (ior * between + beyond) / length;
  // Facets that face down, or that the ray would hit from behind, do not contribute.
  const auto possible = normal > 0.0 && ray > 0.0 && ray_beyond < 0.0;
  const ArrayXd jacobian = (ray * ray_beyond).abs() / (mu * mu_beyond * length.square());
  const ArrayXd passed = transmittances(optics, ray.max(1e-9));
  return possible.select(facets.density(normal.max(1e-9)) * passed * jacobian * mask, 0.0);
}

/// Calls `one` for each column of azimuths.
template <typename One>
ArrayXXd of_pairs(const FacetPairs& pairs, const One& one) {
  ArrayXXd values(pairs.cosines.rows(), pairs.cosines.cols());
  for (Eigen::Index p = 0; p < values.cols(); ++p) {
    values.col(p) = one(pairs.cosines.col(p));
  }
  return values;
}

}  // namespace

ArrayXd Facets::density(const ArrayXd& h) const {
  const double width2 = alpha * alpha;
  const ArrayXd h2 = h.square();
  if (distribution == Distribution::kGgx) {
    return width2 / (pi * (h2 * (width2 - 1.0) + 1.0).square());
  }
  return ((h2 - 1.0) / (h2 * width2)).exp() / (pi * width2 * h2.square());
}

double Facets::density(double h) const {
  const double width2 = alpha * alpha;
  const double h2 = h * h;
  if (distribution == Distribution::kGgx) {
    const double d = h2 * (width2 - 1.0) + 1.0;
    return width2 / (pi * d * d);
  }
  return std::exp((h2 - 1.0) / (h2 * width2)) / (pi * width2 * h2 * h2);
}

double Facets::lambda(double mu) const { return lambda_at(distribution, alpha * sine(mu) / mu); }

double Facets::density(double x, double y, double z) const {
  const Eigen::Vector2d own = in_tangents(angle, x, y);
  const double along = own.x() / alpha;
  const double aside = own.y() / across();
  const double square = along * along + aside * aside;
  const double area = pi * alpha * across();
  if (distribution == Distribution::kGgx) {
    const double d = square + z * z;
    return 1.0 / (area * d * d);
  }
  return std::exp(-square / (z * z)) / (area * z * z * z * z);
}

double Facets::lambda(double x, double y, double z) const {
  const Eigen::Vector2d own = in_tangents(angle, x, y);
  return lambda_at(distribution, Eigen::Vector2d(alpha * own.x(), across() * own.y()).norm() / z);
}

double Facets::masking(double mu_o, double mu_i) const { return masked(lambda(mu_o), lambda(mu_i)); }

ArrayXd facet_reflection(const Facets& facets, const FacetOptics& optics, double mu_o, double mu_i,
                         const ArrayXd& cosines) {
  return reflection(facets, mu_o, mu_i, facets.masking(mu_o, mu_i), cosines,
                    [&](const ArrayXd& c) { return reflectances(optics, c); });
}

ArrayXXd facet_reflection(const Facets& facets, const FacetOptics& optics, double mu, const FacetPairs& pairs) {
  const ArrayXd mask = masking(facets, mu, pairs.mu, false);
  return of_pairs(pairs, [&](const ArrayXd& cosines) {
    return reflection(facets, mu, pairs.mu, mask, cosines, [&](const ArrayXd& c) { return reflectances(optics, c); });
  });
}

ArrayXd opaque_reflection(const Facets& facets, const std::function<double(double)>& reflectance, double mu_o,
                          double mu_i, const ArrayXd& cosines) {
  return reflection(facets, mu_o, mu_i, facets.masking(mu_o, mu_i), cosines,
                    [&](const ArrayXd& c) { return c.unaryExpr(reflectance).eval(); });
}

ArrayXXd opaque_reflection(const Facets& facets, const std::function<double(double)>& reflectance, double mu,
                           const FacetPairs& pairs) {
  const ArrayXd mask = masking(facets, mu, pairs.mu, false);
  return of_pairs(pairs, [&](const ArrayXd& cosines) {
    return reflection(facets, mu, pairs.mu, mask, cosines,
                      [&](const ArrayXd& c) { return c.unaryExpr(reflectance).eval(); });
  });
}

double conductor_fresnel(double mu, std::complex<double> ratio) {
  return conductor_fresnel_array<Eigen::Array<double, 1, 1>>(Eigen::Array<double, 1, 1>(mu), ratio)[0];
}

double mean_conductor_fresnel(std::complex<double> ratio) {
  const Quadrature quadrature(32);
  return (2.0 * quadrature.mu.array() * quadrature.weight.array() *
          conductor_fresnel_array<ArrayXd>(quadrature.mu.array(), ratio))
      .sum();
}

ArrayXd facet_transmission(const Facets& facets, const FacetOptics& optics, double mu, double mu_beyond,
                           const ArrayXd& cosines) {
  return transmission(facets, optics, mu, mu_beyond, facets.passing(mu, mu_beyond), cosines);
}

ArrayXXd facet_transmission(const Facets& facets, const FacetOptics& optics, double mu, const FacetPairs& pairs) {
  const ArrayXd mask = masking(facets, mu, pairs.mu, true);
  return of_pairs(pairs,
                  [&](const ArrayXd& cosines) { return transmission(facets, optics, mu, pairs.mu, mask, cosines); });
}

}  // namespace lamina
