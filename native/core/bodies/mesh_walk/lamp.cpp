// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/lamp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "numeric/tangents.hpp"

namespace lamina {

namespace {

using std::numbers::pi;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMetre = 1000.0;  // in mm

Ray cross(const Ray& a, const Ray& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// A direction within a disc about `axis`, uniform in solid angle.
Ray in_disc(const Ray& axis, double cosine, const LampPoint& point) {
  const double z = 1.0 - point.u * (1.0 - cosine);
  const double sine = sine_of(z);
  const double x = sine * std::cos(2.0 * pi * point.v);
  const double y = sine * std::sin(2.0 * pi * point.v);
  const auto [first, second] = tangents_of(axis.x, axis.y, axis.z);
  return normalised({x * first[0] + y * second[0] + z * axis.x, x * first[1] + y * second[1] + z * axis.y,
                     x * first[2] + y * second[2] + z * axis.z});
}

/// The unit vector from one position to another.
Ray between(const Place& from, const Place& to) {
  const double distance = std::max(from.distance(to), std::numeric_limits<double>::min());
  return {(to.x - from.x) / distance, (to.y - from.y) / distance, (to.z - from.z) / distance};
}

}  // namespace

Lamp Lamp::distant(const Ray& towards, double cosine) {
  Lamp lamp;
  lamp.axis_ = towards;
  lamp.cosine_ = cosine;
  return lamp;
}

Lamp Lamp::sphere(const Place& centre, double radius) {
  Lamp lamp;
  lamp.kind_ = Kind::kSphere;
  lamp.centre_ = centre;
  lamp.radius_ = radius;
  return lamp;
}

Lamp Lamp::spot(const Place& centre, double radius, const Ray& axis, double cosine, double blend) {
  Lamp lamp = sphere(centre, radius);
  lamp.is_spot_ = true;
  lamp.axis_ = axis;
  lamp.cosine_ = cosine;
  lamp.blend_ = blend;
  return lamp;
}

Lamp Lamp::area(const Place& centre, const Ray& first, const Ray& second, bool ellipse) {
  Lamp lamp;
  lamp.kind_ = Kind::kArea;
  lamp.centre_ = centre;
  lamp.first_ = first;
  lamp.second_ = second;
  lamp.is_ellipse_ = ellipse;
  const Ray normal = cross(first, second);
  const double quarter = std::sqrt(normal.dot(normal));
  lamp.axis_ = {normal.x / quarter, normal.y / quarter, normal.z / quarter};
  lamp.area_ = (ellipse ? pi : 4.0) * quarter;
  return lamp;
}

LampLight Lamp::light(const Place& at, const LampPoint& point) const {
  if (kind_ == Kind::kDistant) {
    // The radiance of the disc, 1 / (pi sin^2), times its solid angle, 2 pi (1 - cos).
    return {cosine_ == 1.0 ? axis_ : in_disc(axis_, cosine_, point), kInfinity, 2.0 / (1.0 + cosine_)};
  }
  if (kind_ == Kind::kSphere) {
    const double distance = at.distance(centre_);
    if (distance <= radius_) {
      return {axis_, 0.0, 0.0};
    }
    const double cosine = std::sqrt(1.0 - radius_ * radius_ / (distance * distance));
    const Ray middle = between(at, centre_);
    const Ray towards = radius_ > 0.0 ? in_disc(middle, cosine, point) : middle;
    const double metres = distance / kMetre;
    return {towards, distance - radius_, narrowed(towards) * 2.0 / ((1.0 + cosine) * metres * metres)};
  }
  double a = 2.0 * point.u - 1.0;
  double b = 2.0 * point.v - 1.0;
  if (is_ellipse_) {
    const double radius = std::sqrt(point.u);
    a = radius * std::cos(2.0 * pi * point.v);
    b = radius * std::sin(2.0 * pi * point.v);
  }
  const Place there = {centre_.x + a * first_.x + b * second_.x, centre_.y + a * first_.y + b * second_.y,
                       centre_.z + a * first_.z + b * second_.z};
  const Ray towards = between(at, there);
  const double distance = at.distance(there);
  const double facing = -towards.dot(axis_);
  return {towards, distance, facing > 0.0 ? facing * area_ / (distance * distance) : 0.0};
}

std::optional<Lamp::Seen> Lamp::seen(const Place& from, const Ray& direction) const {
  if (kind_ == Kind::kDistant) {
    if (direction.dot(axis_) < cosine_) {
      return std::nullopt;
    }
    return Seen{1.0 / (pi * (1.0 - cosine_ * cosine_)), kInfinity};
  }
  const Ray to_centre = {centre_.x - from.x, centre_.y - from.y, centre_.z - from.z};
  if (kind_ == Kind::kSphere) {
    const double along = to_centre.dot(direction);
    const double beside = to_centre.dot(to_centre) - along * along;
    if (along <= radius_ || beside >= radius_ * radius_) {
      return std::nullopt;
    }
    return Seen{narrowed(direction) * kMetre * kMetre / (pi * radius_ * radius_), along - radius_};
  }
  const double facing = -direction.dot(axis_);
  const double distance = -to_centre.dot(axis_) / facing;
  if (!(facing > 0.0 && distance > 0.0)) {
    return std::nullopt;
  }
  const Ray off = {distance * direction.x - to_centre.x, distance * direction.y - to_centre.y,
                   distance * direction.z - to_centre.z};
  const double a = off.dot(first_) / first_.dot(first_);
  const double b = off.dot(second_) / second_.dot(second_);
  const bool inside = is_ellipse_ ? a * a + b * b <= 1.0 : std::abs(a) <= 1.0 && std::abs(b) <= 1.0;
  return inside ? std::optional(Seen{1.0, distance}) : std::nullopt;
}

double Lamp::spread(const Place& at) const {
  if (kind_ == Kind::kDistant) {
    return sine_of(cosine_);
  }
  const double radius =
      kind_ == Kind::kSphere ? radius_ : std::sqrt(std::max(first_.dot(first_), second_.dot(second_)));
  return std::min(1.0, radius / std::max(at.distance(centre_), radius));
}

double Lamp::narrowed(const Ray& towards) const {
  if (!is_spot_) {
    return 1.0;
  }
  const double above = -towards.dot(axis_) - cosine_;
  const double width = (1.0 - cosine_) * blend_;
  const double t = above <= 0.0 ? 0.0 : (above >= width ? 1.0 : above / width);
  return t * t * (3.0 - 2.0 * t);
}

Weights Surroundings::along(const Ray& direction) const {
  if (radiance_.empty()) {
    return {1.0, 1.0, 1.0};
  }
  const auto cell = [](double share, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(0.0, share) * static_cast<double>(count)), count - 1);
  };
  const std::size_t row = cell(std::asin(std::clamp(direction.z, -1.0, 1.0)) / pi + 0.5, rows_);
  const std::size_t column = cell(0.5 - std::atan2(direction.y, direction.x) / (2.0 * pi), columns_);
  const float* found = &radiance_[kChannels * (row * columns_ + column)];
  return {static_cast<double>(found[0]), static_cast<double>(found[1]), static_cast<double>(found[2])};
}

}  // namespace lamina
