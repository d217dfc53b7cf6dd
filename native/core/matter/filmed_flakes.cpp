// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/filmed_flakes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "numeric/quadrature.hpp"

namespace lamina {

FilmedFlakes::FilmedFlakes(Film film, double alpha) : film_(std::move(film)) {
  constexpr int kCosines = 64;
  constexpr int kAzimuths = 32;  // of half the circle
  constexpr double kExact = 1e-8;
  // A flake that shows nothing has no place in an exponent.
  constexpr double kLeast = 1e-12;
  const Quadrature rule(kCosines);
  std::array<double, kAzimuths> turn{};
  for (std::size_t k = 0; k < turn.size(); ++k) {
    turn[k] = std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / kAzimuths);
  }
  areas_ = ChebyshevPanels<2>(1.0, kExact, [&](double mu) {
    // Stretched, flakes are a sphere, of which a ray meets normals by their cosine with the stretched ray.
    const double sine2 = std::max(0.0, (1.0 - mu) * (1.0 + mu));
    const double area = std::sqrt(alpha * alpha * sine2 + mu * mu);
    const double up = mu / area;
    const double along = alpha * std::sqrt(sine2) / area;
    std::array<double, 2> sum{};
    for (Eigen::Index i = 0; i < kCosines; ++i) {
      const double c = rule.mu[i];
      const double across = std::sqrt((1.0 - c) * (1.0 + c)) * along;
      for (const double x : turn) {
        const double height = c * up - across * x;
        const double stretch = std::sqrt(height * height + alpha * alpha * (1.0 - height * height));
        const double cosine = std::min(1.0, area * c / stretch);
        const double weight = 2.0 * c * rule.weight[i] * area / kAzimuths;
        sum[0] += weight * reflectance(cosine);
        sum[1] += weight * taken(cosine);
      }
    }
    return std::array<double, 2>{std::max(kLeast, sum[0]), std::max(kLeast, sum[1])};
  });
}

}  // namespace lamina
