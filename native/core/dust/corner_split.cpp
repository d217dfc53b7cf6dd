// SPDX-License-Identifier: GPL-3.0-or-later
#include "dust/corner_split.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace lamina {

namespace {

// Limits the time at an edge with very many faces, and at a vertex with very many normals. Beyond it a group may be
// split into several groups of the same normal; they get the same dust.
constexpr std::size_t kMostCompared = 64;

float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool is_zero(const float* n) { return n[0] == 0.0F && n[1] == 0.0F && n[2] == 0.0F; }

using Corners = std::span<const std::size_t>;

/// Calls groups_of(corners of a vertex, their groups) for each vertex and numbers the groups as points. A group is any
/// number below the number of corners, or kNone.
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

CornerPoints numbered(const TriangleList& triangles, const auto& groups_of) {
  const std::size_t corners = 3 * triangles.count;
  std::vector<std::size_t> start(triangles.vertices + 1, 0);
  for (std::size_t c = 0; c < corners; ++c) {
    ++start[triangles.indices[c] + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::size_t> sorted(corners);
  std::vector<std::size_t> place(start.begin(), start.end() - 1);
  for (std::size_t c = 0; c < corners; ++c) {
    sorted[place[triangles.indices[c]]++] = c;
  }
  CornerPoints result;
  result.point.resize(corners);
  result.vertex.resize(triangles.vertices);
  std::iota(result.vertex.begin(), result.vertex.end(), 0U);
  result.first.assign(triangles.vertices, -1);
  std::vector<std::size_t> group;
  std::vector<std::uint32_t> number;
  for (std::size_t v = 0; v < triangles.vertices; ++v) {
    const Corners own(sorted.data() + start[v], start[v + 1] - start[v]);
    if (own.empty()) {
      continue;
    }
    group.assign(own.size(), kNone);
    groups_of(own, group);
    number.assign(own.size(), 0);
    bool any = false;
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (group[i] == kNone) {
        continue;
      }
      std::uint32_t& point = number[group[i]];
      if (point == 0) {  // stored numbers are one higher, 0 is none
        point = static_cast<std::uint32_t>((any ? result.vertex.size() : v) + 1);
        if (any) {
          result.vertex.push_back(static_cast<std::uint32_t>(v));
          result.first.push_back(0);
        }
        result.first[point - 1] = static_cast<std::int64_t>(own[i]);
        any = true;
      }
      result.point[own[i]] = point - 1;
    }
    if (!any) {
      result.first[v] = static_cast<std::int64_t>(own[0]);
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (group[i] == kNone) {
        result.point[own[i]] = static_cast<std::uint32_t>(v);
      }
    }
  }
  return result;
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

}  // namespace

CornerPoints smooth_corners(const TriangleList& triangles, const float* normals, float cosine) {
  std::vector<std::pair<std::uint32_t, std::size_t>> edges;  // the other end, the position of the vertex's corner
  return numbered(triangles, [&](Corners own, std::vector<std::size_t>& group) {
    edges.clear();
    for (std::size_t i = 0; i < own.size(); ++i) {
      const std::size_t triangle = own[i] / 3;
      if (is_zero(normals + 3 * triangle)) {
        continue;
      }
      group[i] = i;
      for (std::size_t k = 1; k < 3; ++k) {
        edges.emplace_back(triangles.indices[3 * triangle + (own[i] + k) % 3], i);
      }
    }
    std::ranges::sort(edges);
    std::size_t run = 0;  // the first corner at the current edge
    for (std::size_t j = 0; j < edges.size(); ++j) {
      if (edges[j].first != edges[run].first) {
        run = j;
      }
      for (std::size_t i = std::max(run, j - std::min(j, kMostCompared)); i < j; ++i) {
        if (dot(normals + 3 * (own[edges[i].second] / 3), normals + 3 * (own[edges[j].second] / 3)) >= cosine) {
          group[root_of(group, edges[j].second)] = root_of(group, edges[i].second);
        }
      }
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (group[i] != kNone) {
        group[i] = root_of(group, i);
      }
    }
  });
}

CornerPoints distinct_corners(const TriangleList& triangles, const float* normals, float cosine) {
  std::vector<std::size_t> leaders;
  return numbered(triangles, [&](Corners own, std::vector<std::size_t>& group) {
    leaders.clear();
    for (std::size_t i = 0; i < own.size(); ++i) {
      const float* normal = normals + 3 * own[i];
      if (is_zero(normal)) {
        continue;
      }
      group[i] = i;
      const std::size_t compared = std::min(leaders.size(), kMostCompared);
      for (std::size_t k = leaders.size() - compared; k < leaders.size(); ++k) {
        if (dot(normal, normals + 3 * own[leaders[k]]) >= cosine) {
          group[i] = leaders[k];
          break;
        }
      }
      if (group[i] == i) {
        leaders.push_back(i);
      }
    }
  });
}

}  // namespace lamina
