// SPDX-License-Identifier: GPL-3.0-or-later
// The texels of an image on the surface of a solid.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mesh_walk/mesh_walk.hpp"

namespace lamina {

/// An image over a UV map. `uvs`: u v of the three corners of each face, u to the right and v up over [0, 1]. `points`:
/// the number of each texel's point, row by row from the bottom, -1 without one.
struct TexelImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<double> uvs;
  std::vector<std::int32_t> points;
};

/// Divides a surface among the points of an image. A point gets the surface below its texel, and at the border of an
/// island that below the neighbours without a point of their own; but only what lies near the point and is seen from
/// its side.
class SurfaceTexels {
 public:
  SurfaceTexels(const Solid& solid, TexelImage image, std::vector<MeshWalk::Start> points);

  static constexpr std::int32_t kNone = -1;
  /// The number of the point that a place on a face belongs to, or kNone.
  std::int32_t at(std::size_t face, const Place& place) const;
  /// In mm^2, by point.
  const std::vector<double>& areas() const { return areas_; }

 private:
  struct Spot {
    double u, v;  ///< in texels
  };
  using Polygon = std::vector<Spot>;
  /// Texels in a rectangle around a face. The owners of their parts of the face begin at `first`, by rows.
  struct Rectangle {
    std::int32_t left = 0;
    std::int32_t bottom = 0;
    std::int32_t columns = 0;
    std::int32_t rows = 0;
    std::size_t first = 0;
  };
  class Chart;

  static Polygon clipped(const Polygon& polygon, double Spot::* coordinate, double limit, double sign);
  static Polygon part_in_texel(const std::array<Spot, 3>& corners, std::int32_t column, std::int32_t row);
  void divide(std::size_t face);
  std::int32_t owner(const Chart& chart, const Place& place, std::int32_t column, std::int32_t row) const;

  const Solid& solid_;
  TexelImage image_;
  std::vector<MeshWalk::Start> points_;
  std::vector<Rectangle> rectangles_;  ///< by face
  std::vector<std::int32_t> owners_;
  std::vector<double> areas_;
};

}  // namespace lamina
