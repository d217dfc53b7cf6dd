// SPDX-License-Identifier: GPL-3.0-or-later
// One scattering by flakes in a walk.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "events/sphere.hpp"
#include "matter/flakes.hpp"

namespace lamina {

/// What flakes do to light that collides in their medium along `in`.
class FlakeScatter {
 public:
  FlakeScatter(const Flakes& flakes, const Ray& in)
      : flakes_(flakes), in_(in), area_(flakes.area(std::abs(in.z))), met_(area_ / flakes.extinction(std::abs(in.z))) {}

  /// The direction of a ray that leaves, and 4 pi times its density under sample(); `kept`: the share of the light that
  /// goes on, but for the albedo of the medium.
  struct Event {
    Ray ray;
    double density;
    double kept;
  };
  Event to(const Ray& out) const {
    const Ray sum{out.x - in_.x, out.y - in_.y, out.z - in_.z};
    const double length = std::sqrt(sum.dot(sum));
    if (length == 0.0) {
      return {out, 0.0, 0.0};
    }
    const double density = std::numbers::pi * flakes_.density(sum.z / length) / area_;
    return {out, density, met_ * flakes_.reflectance(std::min(1.0, 0.5 * length))};
  }

  /// A flake is met in proportion to the area that it shows (Heitz et al. 2015): stretched, flakes are a sphere.
  Event sample(Rng& rng) const {
    const Azimuth azimuth(rng);
    const double square = rng.uniform();
    const double across = std::sqrt(1.0 - square);
    const Ray seen = normalised({-flakes_.alpha * in_.x, -flakes_.alpha * in_.y, -in_.z});
    const auto [first, second] = tangents_of(seen.x, seen.y, seen.z);
    const double along = std::sqrt(square);
    const double a = across * azimuth.cosine;
    const double b = across * azimuth.sine;
    const Ray normal = normalised({flakes_.alpha * (along * seen.x + a * first[0] + b * second[0]),
                                   flakes_.alpha * (along * seen.y + a * first[1] + b * second[1]),
                                   along * seen.z + a * first[2] + b * second[2]});
    return to(mirrored_at(normal, in_, normal.dot(in_)));
  }

 private:
  const Flakes& flakes_;
  Ray in_;
  double area_;
  double met_;  ///< the share of collisions that are with flakes, over their share along the normal
};

}  // namespace lamina
