// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/nearest_vertices.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace lamina {

namespace {

constexpr std::size_t kBlock = 512;  // vertices of a task

double square_distance(const double* a, const double* b) {
  double sum = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  }
  return sum;
}

}  // namespace

void nearest_vertices(const double* positions, const std::int32_t* along, std::size_t vertices, std::size_t count,
                      std::size_t most, std::int32_t* found, ThreadPool& pool) {
  pool.run((vertices + kBlock - 1) / kBlock, [&](std::size_t block) {
    std::vector<std::int32_t> reached;
    std::vector<std::pair<double, std::int32_t>> away;  // squared distance, number
    for (std::size_t vertex = block * kBlock; vertex < std::min(vertices, (block + 1) * kBlock); ++vertex) {
      const std::int32_t* const own = along + vertex * count;
      reached.assign(own, own + count);
      for (std::size_t k = 0; k < count; ++k) {
        const std::int32_t* const next = along + static_cast<std::size_t>(own[k]) * count;
        reached.insert(reached.end(), next, next + count);
      }
      std::sort(reached.begin(), reached.end());
      reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
      away.clear();
      for (const std::int32_t other : reached) {
        if (static_cast<std::size_t>(other) != vertex) {
          away.emplace_back(square_distance(positions + 3 * vertex, positions + 3 * static_cast<std::size_t>(other)),
                            other);
        }
      }
      const std::size_t kept = std::min(most - 1, away.size());
      std::partial_sort(away.begin(), away.begin() + static_cast<std::ptrdiff_t>(kept), away.end());
      std::int32_t* const out = found + vertex * most;
      std::fill_n(out, most, static_cast<std::int32_t>(vertex));
      for (std::size_t k = 0; k < kept; ++k) {
        out[k + 1] = away[k].second;
      }
    }
  });
}

}  // namespace lamina
