// SPDX-License-Identifier: GPL-3.0-or-later
// Splits vertices at hard edges, where one normal per vertex is not enough.
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

/// Points of a mesh: one for each group of a vertex's corners that share a normal. The first group of vertex v is point
/// v, even if v has no corner; the other groups follow in the order of their vertices.
struct CornerPoints {
  std::vector<std::uint32_t> point;   // of each corner, three per triangle
  std::vector<std::uint32_t> vertex;  // of each point
  std::vector<std::int64_t> first;    // of each point: its lowest corner, or -1 if the vertex has none
};

/// Groups corners by an angle limit: two triangles that share an edge belong to one group at both ends of the edge if
/// the cosine between their normals is at least `cosine`. `normals`: x y z of each triangle, of length 1, or 0 for a
/// triangle without area, whose corners join the first groups of their vertices.
CornerPoints smooth_corners(const TriangleList& triangles, const float* normals, float cosine);

/// Groups corners by their own normals: corners of a vertex share a point if the cosine between their normals is at
/// least `cosine`. `normals`: x y z of each corner, of length 1, or 0 for a corner that joins the first group of its
/// vertex.
CornerPoints distinct_corners(const TriangleList& triangles, const float* normals, float cosine);

}  // namespace lamina
