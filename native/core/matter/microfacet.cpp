// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/microfacet.hpp"

#include <cmath>
#include <numbers>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using std::numbers::pi;

/// Fresnel's reflectance for light at cosine c in a medium of relative index 1 against `ratio`.
ArrayXd dielectric_fresnel(const ArrayXd& c, double ratio) {
  const ArrayXd refracted2 = 1.0 - (1.0 - c.square()) / (ratio * ratio);
  const ArrayXd t = refracted2.max(0.0).sqrt();
  const ArrayXd s = (c - ratio * t) / (c + ratio * t);
  const ArrayXd p = (ratio * c - t) / (ratio * c + t);
  return (refracted2 > 0.0).select(0.5 * (s.square() + p.square()), 1.0);
}

/// Born and Wolf, Principles of Optics, 13.2; real arithmetic so that it runs on whole arrays.
template <typename Array>  // an array of fixed size needs no memory from the heap
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

double sine(double mu) { return std::sqrt(std::max(0.0, 1.0 - mu * mu)); }

/// Of a reflection: cosines of the half vector with the normal and with either direction.
struct Half {
  ArrayXd normal;
  ArrayXd ray;

  Half(double mu_o, double mu_i, const ArrayXd& cosines) {
    // Directions from the surface: forward light comes from the azimuth opposite to the viewer's.
    const ArrayXd between = mu_o * mu_i - sine(mu_o) * sine(mu_i) * cosines;
    ray = (0.5 * (1.0 + between)).max(1e-12).sqrt();
    normal = ((mu_o + mu_i) / (2.0 * ray)).min(1.0);
  }
};

}  // namespace

ArrayXd Facets::density(const ArrayXd& h) const {
  const double width2 = alpha * alpha;
  const ArrayXd h2 = h.square();
  if (distribution == Distribution::kGgx) {
    return width2 / (pi * (h2 * (width2 - 1.0) + 1.0).square());
  }
  return ((h2 - 1.0) / (h2 * width2)).exp() / (pi * width2 * h2.square());
}

double Facets::lambda(double mu) const {
  const double slope = alpha * sine(mu) / mu;
  if (slope == 0.0) {
    return 0.0;
  }
  if (distribution == Distribution::kGgx) {
    return 0.5 * (std::sqrt(1.0 + slope * slope) - 1.0);
  }
  const double a = 1.0 / slope;
  return 0.5 * (std::erf(a) - 1.0 + std::exp(-a * a) / (a * std::sqrt(pi)));
}

double Facets::masking(double mu_o, double mu_i) const {
  const double o = lambda(mu_o);
  const double i = lambda(mu_i);
  return correlated ? 1.0 / (1.0 + o + i) : 1.0 / ((1.0 + o) * (1.0 + i));
}

ArrayXd dielectric_reflection(const Facets& facets, double ior, double beyond, double mu_o, double mu_i,
                              const ArrayXd& cosines) {
  const Half half(mu_o, mu_i, cosines);
  return facets.density(half.normal) * dielectric_fresnel(half.ray, beyond / ior) *
         (facets.masking(mu_o, mu_i) / (4.0 * mu_o * mu_i));
}

ArrayXd conductor_reflection(const Facets& facets, std::complex<double> ratio, double mu_o, double mu_i,
                             const ArrayXd& cosines) {
  const Half half(mu_o, mu_i, cosines);
  return facets.density(half.normal) * conductor_fresnel_array(half.ray, ratio) *
         (facets.masking(mu_o, mu_i) / (4.0 * mu_o * mu_i));
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

ArrayXd dielectric_transmission(const Facets& facets, double ior_above, double ior_below, double mu_above,
                                double mu_below, const ArrayXd& cosines) {
  const double s_above = sine(mu_above);
  const double s_below = sine(mu_below);
  // Light from above comes from (-s_above, 0, mu_above) and leaves to (s_below cos, s_below sin, -mu_below).
  // Twice the product of the two, and the half vector n_a w_a + n_b w_b, turned towards the thinner medium.
  const ArrayXd between = -s_above * s_below * cosines - mu_above * mu_below;
  const double turn = ior_above > ior_below ? 1.0 : -1.0;
  const ArrayXd length =
      (ior_above * ior_above + ior_below * ior_below + 2.0 * ior_above * ior_below * between).max(1e-24).sqrt();
  const ArrayXd normal = turn * (ior_above * mu_above - ior_below * mu_below) / length;
  const ArrayXd ray_above = turn * (ior_above + ior_below * between) / length;
  const ArrayXd ray_below = turn * (ior_above * between + ior_below) / length;
  // Facets that face the wrong way, or that the ray would have to pass from behind, carry nothing.
  const auto possible = normal > 0.0 && ray_above > 0.0 && ray_below < 0.0;
  const ArrayXd jacobian = (ray_above * ray_below).abs() / (mu_above * mu_below * length.square());
  const ArrayXd passed = 1.0 - dielectric_fresnel(ray_above.max(1e-9), ior_below / ior_above);
  return possible.select(facets.density(normal.max(1e-9)) * passed * jacobian * facets.masking(mu_above, mu_below),
                         0.0);
}

}  // namespace lamina
