// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the number of sublayers of each graded layer.
#pragma once
#include "numeric/thread_pool.hpp"
#include "solve/sublayer_stack.hpp"

namespace lamina {

/// Divides graded layers into enough sublayers for the relative error `tolerance` at cosines >= .05. Each graded layer
/// is solved alone on few nodes, and its sublayers are doubled until the values agree. Throws std::runtime_error, with
/// the numbers, if the two finest divisions differ.
SublayerStack resolved_sublayers(const Stack& stack, double tolerance, ThreadPool& pool);

}  // namespace lamina
