// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses into how many sublayers each graded layer is divided.
#pragma once
#include "numeric/thread_pool.hpp"
#include "solve/sublayer_stack.hpp"

namespace lamina {

/// The stack with as many sublayers as its graded layers need for values good to `tolerance`, relative, at cosines
/// >= .05. Each graded layer alone is solved on few nodes with sublayers and with twice as many, until the two agree.
/// Throws std::runtime_error, with the numbers, where the finest still differ.
SublayerStack resolved_sublayers(const Stack& stack, double tolerance, ThreadPool& pool);

}  // namespace lamina
