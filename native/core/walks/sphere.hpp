// SPDX-License-Identifier: GPL-3.0-or-later
// Directions of travel, frames about them, and rotations.
#pragma once
#include <algorithm>
#include <cmath>

#include "numeric/rng.hpp"

namespace lamina {

/// A direction of travel; z points up, out of the stack.
struct Ray {
  double x = 0.0;
  double y = 0.0;
  double z = 1.0;

  double dot(const Ray& other) const { return x * other.x + y * other.y + z * other.z; }
  Ray operator-() const { return {-x, -y, -z}; }
  Ray mirrored() const { return {x, y, -z}; }
};

inline Ray normalised(const Ray& ray) {
  const double length = std::sqrt(ray.dot(ray));
  return {ray.x / length, ray.y / length, ray.z / length};
}

inline double sine_of(double cosine) { return std::sqrt(std::max(0.0, 1.0 - cosine * cosine)); }

/// A direction of the unit circle with uniform azimuth: from a point of the unit disc, without a sine or a cosine.
struct Azimuth {
  double cosine;
  double sine;

  explicit Azimuth(Rng& rng) {
    constexpr double kScale = 0x1.0p-31;
    double square = 0.0;
    do {
      const std::uint64_t bits = rng.bits();
      cosine = (static_cast<double>(bits >> 32U) + 0.5) * kScale - 1.0;
      sine = (static_cast<double>(bits & 0xffffffffU) + 0.5) * kScale - 1.0;
      square = cosine * cosine + sine * sine;
    } while (square > 1.0);
    // Twice the angle is uniform as well and needs no square root.
    const double x = (cosine * cosine - sine * sine) / square;
    sine = 2.0 * cosine * sine / square;
    cosine = x;
  }
};

/// `ray` turned by an angle of this cosine, with uniform azimuth about it. The frame is that of Duff et al. (JCGT
/// 2017).
inline Ray scattered(const Ray& ray, double cosine, Rng& rng) {
  const Azimuth azimuth(rng);
  const double sine = sine_of(cosine);
  const double x = sine * azimuth.cosine;
  const double y = sine * azimuth.sine;
  const double sign = std::copysign(1.0, ray.z);
  const double a = -1.0 / (sign + ray.z);
  const double b = ray.x * ray.y * a;
  const Ray turned{cosine * ray.x + x * (1.0 + sign * ray.x * ray.x * a) + y * b,
                   cosine * ray.y + x * sign * b + y * (sign + ray.y * ray.y * a),
                   cosine * ray.z - (x * sign * ray.x + y * ray.y)};
  // Rounding must not add up over thousands of events.
  const double correction = 1.5 - 0.5 * turned.dot(turned);
  return {turned.x * correction, turned.y * correction, turned.z * correction};
}

/// A cosine-weighted direction of the upper hemisphere.
inline Ray lambert_ray(Rng& rng) {
  const Azimuth azimuth(rng);
  const double square = rng.uniform();
  const double sine = std::sqrt(square);
  return {sine * azimuth.cosine, sine * azimuth.sine, std::sqrt(1.0 - square)};
}

}  // namespace lamina
