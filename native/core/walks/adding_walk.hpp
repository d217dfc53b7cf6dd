// SPDX-License-Identifier: GPL-3.0-or-later
// The adding series as a random walk between layers that scatter by tables.
#pragma once
#include <memory>

#include "numeric/thread_pool.hpp"
#include "walks/walk.hpp"
#include "walks/walk_elements.hpp"

namespace lamina {

/// The adding series R1 + T1 R2 T1 + T1 R2 R1 R2 T1 + ... of any number of layers as a random walk between
/// layers, each of which scatters by its own whole scattering function (LayerTable): an event is a passage through
/// a layer, whatever its thickness.
///
/// Unbiased for layers that scatter as their tables do; `table_error` is how far these are from the layers. With one
/// layer and no boundary or base that returns light the series has one term: its values are read from the layer's
/// table, every sample is the same, and there are no events.
struct AddingWalk {
  std::unique_ptr<Walk> walk;
  double table_error = 0.0;
};

/// Throws std::invalid_argument, and std::runtime_error where a layer cannot be solved.
AddingWalk make_adding_walk(const Stack& stack, const WalkTarget& target, ThreadPool& pool);

}  // namespace lamina
