// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/surface_texels.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh_walk/walk_start.hpp"

namespace lamina {

namespace {

constexpr double kNear = 2.0;  // texels: what lies farther from a point does not belong to the point

Ray between(const Place& from, const Place& to) { return {to.x - from.x, to.y - from.y, to.z - from.z}; }
double length(const Ray& ray) { return std::sqrt(ray.dot(ray)); }

}  // namespace

/// A face and its place in the image.
class SurfaceTexels::Chart {
 public:
  Chart(const Solid& solid, const TexelImage& image, std::size_t face) : origin_(solid.corners(face)[0]) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double* uv = &image.uvs[6 * face + 2 * k];
      spots_[k] = {uv[0] * image.width, uv[1] * image.height};
    }
    const auto [a, b, c] = solid.corners(face);
    first_ = between(a, b);
    second_ = between(a, c);
    cross_ = {first_.y * second_.z - first_.z * second_.y, first_.z * second_.x - first_.x * second_.z,
              first_.x * second_.y - first_.y * second_.x};
    right_ = {spots_[1].u - spots_[0].u, spots_[2].u - spots_[0].u};
    up_ = {spots_[1].v - spots_[0].v, spots_[2].v - spots_[0].v};
    twice_ = right_[0] * up_[1] - right_[1] * up_[0];
  }

  const std::array<Spot, 3>& spots() const { return spots_; }
  /// Along the face's normal.
  const Ray& cross() const { return cross_; }
  bool is_flat() const { return twice_ == 0.0 || cross_.dot(cross_) == 0.0; }
  /// In mm^2, of a texel.
  double texel_area() const { return length(cross_) / std::abs(twice_); }
  /// In mm, of the longer side of a texel.
  double texel_side() const { return std::max(length(step(up_[1], -up_[0])), length(step(-right_[1], right_[0]))); }

  Place place(const Spot& spot) const {
    const double u = spot.u - spots_[0].u;
    const double v = spot.v - spots_[0].v;
    return origin_.moved(step(up_[1] * u - right_[1] * v, right_[0] * v - up_[0] * u), 1.0);
  }
  Spot spot(const Place& place) const {
    const Ray off = between(origin_, place);
    const double square = cross_.dot(cross_);
    const double ff = first_.dot(first_);
    const double fs = first_.dot(second_);
    const double ss = second_.dot(second_);
    const double s = (off.dot(first_) * ss - off.dot(second_) * fs) / square;
    const double t = (off.dot(second_) * ff - off.dot(first_) * fs) / square;
    return {spots_[0].u + s * right_[0] + t * right_[1], spots_[0].v + s * up_[0] + t * up_[1]};
  }

 private:
  /// s / twice along the first side and t / twice along the second.
  Ray step(double s, double t) const {
    return {(s * first_.x + t * second_.x) / twice_, (s * first_.y + t * second_.y) / twice_,
            (s * first_.z + t * second_.z) / twice_};
  }

  Place origin_;
  std::array<Spot, 3> spots_;
  Ray first_, second_, cross_;
  std::array<double, 2> right_, up_;  ///< u and v of the sides
  double twice_;                      ///< the area in texels
};

SurfaceTexels::SurfaceTexels(const Solid& solid, TexelImage image, std::vector<MeshWalk::Start> points)
    : solid_(solid),
      image_(std::move(image)),
      points_(std::move(points)),
      rectangles_(solid.faces()),
      areas_(points_.size()) {
  for (std::size_t face = 0; face < solid.faces(); ++face) {
    if (!solid.is_opaque(face)) {
      divide(face);
    }
  }
}

void SurfaceTexels::divide(std::size_t face) {
  const Chart chart(solid_, image_, face);
  if (chart.is_flat()) {
    return;
  }
  const auto& [a, b, c] = chart.spots();
  const auto texel = [](double value, std::int32_t count) {
    return static_cast<std::int32_t>(std::clamp(std::floor(value), 0.0, count - 1.0));
  };
  Rectangle& around = rectangles_[face];
  around.left = texel(std::min({a.u, b.u, c.u}), image_.width);
  around.bottom = texel(std::min({a.v, b.v, c.v}), image_.height);
  around.columns = texel(std::max({a.u, b.u, c.u}), image_.width) - around.left + 1;
  around.rows = texel(std::max({a.v, b.v, c.v}), image_.height) - around.bottom + 1;
  around.first = owners_.size();
  for (std::int32_t row = around.bottom; row < around.bottom + around.rows; ++row) {
    for (std::int32_t column = around.left; column < around.left + around.columns; ++column) {
      const Polygon part = part_in_texel(chart.spots(), column, row);
      owners_.push_back(kNone);
      if (part.size() < 3) {
        continue;
      }
      double twice = 0.0;
      Spot middle = {0.0, 0.0};
      for (std::size_t k = 0; k < part.size(); ++k) {
        const Spot& next = part[(k + 1) % part.size()];
        twice += part[k].u * next.v - next.u * part[k].v;
        middle.u += part[k].u / static_cast<double>(part.size());
        middle.v += part[k].v / static_cast<double>(part.size());
      }
      const Place place = chart.place(middle);
      if (!is_buried(solid_, place, normalised(chart.cross()))) {
        owners_.back() = owner(chart, place, column, row);
      }
      if (owners_.back() != kNone) {
        areas_[static_cast<std::size_t>(owners_.back())] += 0.5 * std::abs(twice) * chart.texel_area();
      }
    }
  }
}

/// The part of a polygon where the sign of coordinate - limit is `sign`.
SurfaceTexels::Polygon SurfaceTexels::clipped(const Polygon& polygon, double Spot::* coordinate, double limit,
                                              double sign) {
  Polygon found;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Spot& here = polygon[k];
    const Spot& next = polygon[(k + 1) % polygon.size()];
    const double above = sign * (here.*coordinate - limit);
    const double then = sign * (next.*coordinate - limit);
    if (above >= 0.0) {
      found.push_back(here);
    }
    if ((above < 0.0) != (then < 0.0)) {
      const double share = above / (above - then);
      found.push_back({here.u + share * (next.u - here.u), here.v + share * (next.v - here.v)});
    }
  }
  return found;
}

SurfaceTexels::Polygon SurfaceTexels::part_in_texel(const std::array<Spot, 3>& corners, std::int32_t column,
                                                    std::int32_t row) {
  Polygon part = {corners.begin(), corners.end()};
  part = clipped(part, &Spot::u, column, 1.0);
  part = clipped(part, &Spot::u, column + 1.0, -1.0);
  part = clipped(part, &Spot::v, row, 1.0);
  return clipped(part, &Spot::v, row + 1.0, -1.0);
}

std::int32_t SurfaceTexels::owner(const Chart& chart, const Place& place, std::int32_t column, std::int32_t row) const {
  double nearest = kNear * chart.texel_side();
  std::int32_t found = kNone;
  const auto number = [&](std::int32_t x, std::int32_t y) {
    const bool inside = x >= 0 && y >= 0 && x < image_.width && y < image_.height;
    return inside ? image_.points[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                                  static_cast<std::size_t>(x)]
                  : kNone;
  };
  const auto ask = [&](std::int32_t x, std::int32_t y) {
    const std::int32_t other = number(x, y);
    if (other == kNone) {
      return;
    }
    const MeshWalk::Start& point = points_[static_cast<std::size_t>(other)];
    if (point.normal.dot(chart.cross()) > 0.0 && point.place.distance(place) < nearest) {
      nearest = point.place.distance(place);
      found = other;
    }
  };
  ask(column, row);
  if (number(column, row) == kNone) {
    for (std::int32_t y = row - 1; y <= row + 1; ++y) {
      for (std::int32_t x = column - 1; x <= column + 1; ++x) {
        ask(x, y);
      }
    }
  }
  return found;
}

std::int32_t SurfaceTexels::at(std::size_t face, const Place& place) const {
  const Rectangle& around = rectangles_[face];
  if (around.columns == 0) {
    return kNone;
  }
  const Spot spot = Chart(solid_, image_, face).spot(place);
  const auto column = static_cast<std::int32_t>(std::floor(spot.u)) - around.left;
  const auto row = static_cast<std::int32_t>(std::floor(spot.v)) - around.bottom;
  if (column < 0 || row < 0 || column >= around.columns || row >= around.rows) {
    return kNone;
  }
  return owners_[around.first + static_cast<std::size_t>(row) * static_cast<std::size_t>(around.columns) +
                 static_cast<std::size_t>(column)];
}

}  // namespace lamina
