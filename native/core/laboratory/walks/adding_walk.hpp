// SPDX-License-Identifier: GPL-3.0-or-later
// The adding series as a random walk between layers that scatter by tables.
#pragma once
#include <memory>

#include "numeric/thread_pool.hpp"
#include "walks/walk.hpp"
#include "walks/walk_elements.hpp"

namespace lamina {

/// The adding series R1 + T1 R2 T1 + T1 R2 R1 R2 T1 + ... of any number of layers as a random walk between the layers.
/// Each layer scatters by its whole scattering function (LayerTable); an event is a passage through a layer of any
/// thickness.
///
/// Unbiased up to the error of the tables, `table_error`. With one layer and no boundary or base that reflects light,
/// the series has one term: its value is read from the layer's table, all samples are equal, and there are no events.
struct AddingWalk {
  std::unique_ptr<Walk> walk;
  double table_error = 0.0;
};

/// Throws std::invalid_argument, and std::runtime_error where a layer cannot be solved.
AddingWalk make_adding_walk(const Stack& stack, const WalkTarget& target, ThreadPool& pool);

}  // namespace lamina
