// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/surface_boundary.hpp"

#include <algorithm>
#include <cmath>

#include "matter/fresnel.hpp"
#include "numeric/tangents.hpp"

namespace lamina {

namespace {

/// A local frame whose z axis is the normal.
struct NormalFrame {
  Ray first, second, normal;

  explicit NormalFrame(const Ray& n) : normal(n) {
    const auto [a, b] = tangents_of(n.x, n.y, n.z);
    first = {a[0], a[1], a[2]};
    second = {b[0], b[1], b[2]};
  }
  Ray local(const Ray& ray) const { return {ray.dot(first), ray.dot(second), ray.dot(normal)}; }
  Ray world(const Ray& ray) const {
    return normalised({ray.x * first.x + ray.y * second.x + ray.z * normal.x,
                       ray.x * first.y + ray.y * second.y + ray.z * normal.y,
                       ray.x * first.z + ray.y * second.z + ray.z * normal.z});
  }
};

/// Reflection and refraction of light along `in` at a smooth boundary. `along`: cosine between `in` and the normal; its
/// sign gives the side. `from`, `to`: refractive indices before and behind the boundary.
struct SmoothMeeting {
  double reflected;  ///< share of the power
  Ray refracted;

  SmoothMeeting(const Ray& in, const Ray& normal, double along, double from, double to) {
    const double ratio = from / to;
    const double mu = std::abs(along);
    const double sine2 = (1.0 - mu * mu) * ratio * ratio;
    if (sine2 >= 1.0) {
      reflected = 1.0;
      return;
    }
    const double cosine = std::sqrt(1.0 - sine2);
    reflected = fresnel(mu, cosine, from, to);
    const double turn = std::copysign(cosine, along) - ratio * along;
    refracted =
        normalised({ratio * in.x + turn * normal.x, ratio * in.y + turn * normal.y, ratio * in.z + turn * normal.z});
  }

  /// At the surface of a solid of index `ior`; inside, `along` is positive.
  static SmoothMeeting from_either_side(const Ray& in, const Ray& normal, double along, double ior) {
    return along > 0.0 ? SmoothMeeting(in, normal, along, ior, 1.0) : SmoothMeeting(in, normal, along, 1.0, ior);
  }
};

}  // namespace

SurfaceBoundary::SurfaceBoundary(double ior, const Facets* facets)
    : kind_(Kind::kMatched), ior_(ior), alpha_(facets == nullptr ? 0.0 : facets->alpha) {
  if (ior != 1.0) {
    kind_ = facets == nullptr ? Kind::kSmooth : Kind::kRough;
  }
  if (kind_ == Kind::kRough) {
    rough_ = std::make_shared<const FacetScatter>(*facets, FacetOptics{1.0, ior});
  }
}

SurfaceBoundary::Outcome SurfaceBoundary::meet(const Ray& in, const Ray& normal, Rng& rng) const {
  if (kind_ == Kind::kMatched) {
    return {in, 1.0};
  }
  if (kind_ == Kind::kRough) {
    const NormalFrame frame(normal);
    const FacetScatter::Outcome outcome = rough_->sample(frame.local(in), rng);
    return {frame.world(outcome.ray), outcome.weight};
  }
  const double along = std::clamp(in.dot(normal), -1.0, 1.0);
  const SmoothMeeting meeting = SmoothMeeting::from_either_side(in, normal, along, ior_);
  return {rng.uniform() >= meeting.reflected ? meeting.refracted : mirrored_at(normal, in, along), 1.0};
}

SurfaceBoundary::Outcome SurfaceBoundary::enter(const Ray& in, const Ray& normal) const {
  if (kind_ == Kind::kMatched) {
    return {in, 1.0};
  }
  const SmoothMeeting meeting(in, normal, std::clamp(in.dot(normal), -1.0, 0.0), 1.0, ior_);
  return {meeting.refracted, 1.0 - meeting.reflected};
}

SurfaceBoundary::Outcome SurfaceBoundary::leaving(const Ray& in, const Ray& normal) const {
  const double along = std::clamp(in.dot(normal), -1.0, 1.0);
  const SmoothMeeting meeting = SmoothMeeting::from_either_side(in, normal, along, ior_);
  if (along > 0.0) {
    return {meeting.refracted, 1.0 - meeting.reflected};
  }
  return {mirrored_at(normal, in, along), meeting.reflected};
}

double SurfaceBoundary::blur() const { return alpha_ * std::abs(1.0 - 1.0 / ior_); }

double SurfaceBoundary::leaving(const Ray& in, const Ray& out, const Ray& normal) const {
  const NormalFrame frame(normal);
  const Ray up = frame.local(out);
  return up.z > 0.0 ? rough_->value(frame.local(in), up) * up.z : 0.0;
}

}  // namespace lamina
