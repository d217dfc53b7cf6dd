// SPDX-License-Identifier: GPL-3.0-or-later
// One scattering by flakes in a walk.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "events/sphere.hpp"
#include "matter/flakes.hpp"

namespace lamina {

/// What a flake does to light that collides in its medium along `in`.
class FlakeScatter {
 public:
  /// Draws the normal of the flake. It is met in proportion to the area that it shows (Heitz et al. 2015): stretched,
  /// flakes are a sphere. Flakes that pass the light are no collisions.
  FlakeScatter(const Flakes& flakes, const Ray& in, Rng& rng)
      : flakes_(flakes),
        in_(in),
        area_(flakes.taking_area(std::abs(in.z))),
        met_(area_ / flakes.extinction(std::abs(in.z))),
        normal_(met_normal(flakes.alpha, in, rng)) {
    constexpr double kUnseen = 1e-9;  // light that collides there is absorbed by the binder
    while (flakes.filmed && area_ > kUnseen && rng.uniform() >= flakes.taken(std::abs(normal_.dot(in)))) {
      normal_ = met_normal(flakes.alpha, in, rng);
    }
  }

  /// The direction of a ray that leaves, and 4 pi times its density under sample(), of matte flakes for their normal;
  /// `kept`: the share of the light that goes on, but for the albedo of the medium.
  struct Event {
    Ray ray;
    double density;
    double kept;
  };
  Event to(const Ray& out) const {
    if (flakes_.translucency) {
      const double cosine = out.dot(normal_);
      const double share = cosine < 0.0 ? *flakes_.translucency : 1.0 - *flakes_.translucency;
      return {out, 4.0 * share * std::abs(cosine), met_};
    }
    const Ray sum{out.x - in_.x, out.y - in_.y, out.z - in_.z};
    const double length = std::sqrt(sum.dot(sum));
    if (length == 0.0) {
      return {out, 0.0, 0.0};
    }
    const double cosine = std::min(1.0, 0.5 * length);
    const double taken = flakes_.taken(cosine);
    const double density = std::numbers::pi * flakes_.density(sum.z / length) * taken / area_;
    return {out, density, taken > 0.0 ? met_ * flakes_.reflectance(cosine) / taken : 0.0};
  }

  Event sample(Rng& rng) const {
    if (!flakes_.translucency) {
      return to(mirrored_at(normal_, in_, normal_.dot(in_)));
    }
    const double side = rng.uniform() < *flakes_.translucency ? -1.0 : 1.0;
    const Ray turned = about(normal_, lambert_ray(rng));
    return to({side * turned.x, side * turned.y, side * turned.z});
  }

 private:
  /// A direction given in a frame whose z axis is `axis`.
  static Ray about(const Ray& axis, const Ray& ray) {
    const auto [first, second] = tangents_of(axis.x, axis.y, axis.z);
    return {ray.z * axis.x + ray.x * first[0] + ray.y * second[0],
            ray.z * axis.y + ray.x * first[1] + ray.y * second[1],
            ray.z * axis.z + ray.x * first[2] + ray.y * second[2]};
  }

  static Ray met_normal(double alpha, const Ray& in, Rng& rng) {
    const Azimuth azimuth(rng);
    const double square = rng.uniform();
    const double across = std::sqrt(1.0 - square);
    const Ray seen = normalised({-alpha * in.x, -alpha * in.y, -in.z});
    const Ray normal = about(seen, {across * azimuth.cosine, across * azimuth.sine, std::sqrt(square)});
    return normalised({alpha * normal.x, alpha * normal.y, normal.z});
  }

  const Flakes& flakes_;
  Ray in_;
  double area_;
  double met_;  ///< the share of collisions that are with flakes, over their share of all that light might meet
  Ray normal_;
};

}  // namespace lamina
