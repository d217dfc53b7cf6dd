// SPDX-License-Identifier: GPL-3.0-or-later
// Directions of travel, frames about them, and rotations.
#pragma once
#include <algorithm>
#include <cmath>

#include "numeric/rng.hpp"
#include "numeric/tangents.hpp"

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

/// `ray` mirrored at a plane with this normal; `along`: the cosine between both.
inline Ray mirrored_at(const Ray& normal, const Ray& ray, double along) {
  const double twice = 2.0 * along;
  return normalised({ray.x - twice * normal.x, ray.y - twice * normal.y, ray.z - twice * normal.z});
}

inline double sine_of(double cosine) { return std::sqrt(std::max(0.0, 1.0 - cosine * cosine)); }

/// A uniform point of the unit circle, from a point of the unit disc by rejection, without a sine or a cosine.
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
    // Twice the angle is uniform too and needs no square root.
    const double x = (cosine * cosine - sine * sine) / square;
    sine = 2.0 * cosine * sine / square;
    cosine = x;
  }
};

/// `ray` turned by an angle of this cosine, with uniform azimuth about it.
inline Ray scattered(const Ray& ray, double cosine, Rng& rng) {
  const Azimuth azimuth(rng);
  const double sine = sine_of(cosine);
  const double x = sine * azimuth.cosine;
  const double y = sine * azimuth.sine;
  const auto [first, second] = tangents_of(ray.x, ray.y, ray.z);
  const Ray turned{cosine * ray.x + x * first[0] + y * second[0], cosine * ray.y + x * first[1] + y * second[1],
                   cosine * ray.z + (x * first[2] + y * second[2])};
  // One Newton step towards length 1, so that rounding does not accumulate over thousands of events.
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
