// SPDX-License-Identifier: GPL-3.0-or-later
// The nearest vertices of a mesh, along its edges.
#pragma once
#include <cstddef>
#include <cstdint>

#include "numeric/thread_pool.hpp"

namespace lamina {

/// `found` [vertex, most]: of the neighbours `along` [vertex, count] of each vertex and of their own neighbours, the
/// nearest by `positions` [vertex, 3]. The first is the vertex itself, and so are those that are missing where there
/// are fewer; so may be those in `along`.
void nearest_vertices(const double* positions, const std::int32_t* along, std::size_t vertices, std::size_t count,
                      std::size_t most, std::int32_t* found, ThreadPool& pool);

}  // namespace lamina
