// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps of unit strength, and the surroundings of a solid.
#pragma once
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "interior/channels.hpp"
#include "interior/place.hpp"
#include "numeric/rng.hpp"

namespace lamina {

/// A random point of a lamp, as two numbers in (0, 1).
struct LampPoint {
  double u;
  double v;

  explicit LampPoint(Rng& rng) : u(rng.uniform()), v(rng.uniform()) {}
};

/// Light that arrives at a position from one point of a lamp, as an estimate for the entire lamp.
struct LampLight {
  Ray towards;        ///< unit vector to the point of the lamp
  double distance;    ///< mm
  double irradiance;  ///< on a plane perpendicular to `towards`
};

/// A lamp of one of three kinds:
///   distant: a disc at infinity that gives irradiance 1;
///   sphere: gives irradiance 1 at a distance of 1 m from its centre, and may be narrowed to a spot;
///   area: a rectangle or an ellipse of radiance 1 that shines to one side.
class Lamp {
 public:
  /// `cosine`: of the disc's angular radius; 1: all light comes from one direction.
  static Lamp distant(const Ray& towards, double cosine);
  /// `radius`: in mm; 0: a point.
  static Lamp sphere(const Place& centre, double radius);
  /// A sphere that shines into a cone. `cosine`: of half the cone's angle; `blend`: share of 1 - cosine over which the
  /// light falls to 0, by a smooth step.
  static Lamp spot(const Place& centre, double radius, const Ray& axis, double cosine, double blend);
  /// `first`, `second`: from the centre to the middle of two edges, in mm, perpendicular to each other. The lamp shines
  /// to the side of first x second.
  static Lamp area(const Place& centre, const Ray& first, const Ray& second, bool ellipse);

  LampLight light(const Place& at, const LampPoint& point) const;

  /// What a ray from a position sees of the lamp: the radiance, and the distance in mm.
  struct Seen {
    double radiance;
    double distance;
  };
  std::optional<Seen> seen(const Place& from, const Ray& direction) const;

  /// The linking of the lamp's light, see Occluders.
  unsigned linking() const { return linking_; }
  void link(unsigned linking) { linking_ = linking; }

  /// The sine of the largest angle between directions from a position to two points of the lamp, at most 1.
  double spread(const Place& at) const;

 private:
  enum class Kind { kDistant, kSphere, kArea };
  Lamp() = default;
  double narrowed(const Ray& towards) const;

  Kind kind_ = Kind::kDistant;
  unsigned linking_ = 0;
  Ray axis_;  ///< distant: to the lamp; otherwise: along which the lamp shines
  double cosine_ = 1.0;
  double blend_ = 0.0;
  bool is_spot_ = false;
  Place centre_;
  double radius_ = 0.0;
  Ray first_;
  Ray second_;
  double area_ = 0.0;
  bool is_ellipse_ = false;
};

/// The radiance of the surroundings by direction: a table of longitude and latitude, constant in each cell. Rows go
/// from -z to +z; columns go from azimuth pi down to -pi, where azimuth 0 is +x and pi / 2 is +y. Cycles has the same
/// convention for equirectangular images.
class Surroundings {
 public:
  /// The same radiance of 1 from all directions.
  Surroundings() = default;
  Surroundings(std::size_t rows, std::size_t columns, std::vector<float> radiance)
      : rows_(rows), columns_(columns), radiance_(std::move(radiance)) {}

  Weights along(const Ray& direction) const;

 private:
  std::size_t rows_ = 0;
  std::size_t columns_ = 0;
  std::vector<float> radiance_;  ///< [row][column][channel]
};

}  // namespace lamina
