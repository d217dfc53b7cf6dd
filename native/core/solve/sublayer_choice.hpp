// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the number of sublayers of each graded layer.
#pragma once
#include "numeric/thread_pool.hpp"
#include "solve/sublayer_stack.hpp"

namespace lamina {

/// The stack with enough sublayers for the relative error `tolerance` at cosines >= .05. Each graded layer is solved
/// alone on few nodes, with twice as many sublayers until the values agree. Throws std::runtime_error, with the
/// numbers, if the finest two differ.
SublayerStack resolved_sublayers(const Stack& stack, double tolerance, ThreadPool& pool);

}  // namespace lamina
