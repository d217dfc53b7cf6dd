// SPDX-License-Identifier: GPL-3.0-or-later
// Vertices at hard edges, where one normal a vertex does not suffice.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamina {

/// Triangles as three vertex numbers each, all below `vertices`.
struct TriangleList {
  const std::uint32_t* indices;
  std::size_t count;
  std::size_t vertices;
};

/// Points of a mesh: one for each group of a vertex's corners that have the same normal. The first group of vertex v is
/// point v, also where v has no corner; the further groups follow in the order of their vertices.
struct CornerPoints {
  std::vector<std::uint32_t> point;   // of each corner, three a triangle
  std::vector<std::uint32_t> vertex;  // of each point
  std::vector<std::int64_t> first;    // corner of each point, the lowest of the group; -1: the vertex has no corner
};

/// Groups by an angle limit: two triangles that share an edge belong to one group at both its ends when the cosine
/// between their normals is at least `cosine`. `normals`: x y z of each triangle, of length 1, or 0 where the triangle
/// has no area: such a corner joins the first group of its vertex.
CornerPoints smooth_corners(const TriangleList& triangles, const float* normals, float cosine);

/// Groups by given normals: corners of one vertex whose normals have a cosine of at least `cosine` share a point.
/// `normals`: x y z of each corner, of length 1, or 0: such a corner joins the first group of its vertex.
CornerPoints distinct_corners(const TriangleList& triangles, const float* normals, float cosine);

}  // namespace lamina
