// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "stack.hpp"
#include "thread_pool.hpp"

namespace lamina {

/// A stack as it is solved: graded layers are replaced by homogeneous slices, and interfaces between media of one
/// index, which reflect and deflect nothing, are left out.
struct SlicedStack {
  Stack stack;
  std::vector<std::size_t> first;  ///< by layer of the stack as it was given: its first slice, or the next
                                   ///< layer's where it is left out; one past all at the end
  std::vector<double> share;       ///< by slice: of its layer's thickness

  /// As many slices as graded layers need for values good to `tolerance`, relative, at cosines >= .05: each layer alone
  /// is solved on few nodes with slices and with twice as many. Throws std::runtime_error, with the numbers, where the
  /// finest still differ.
  SlicedStack(const Stack& given, double tolerance, ThreadPool& pool);
};

}  // namespace lamina
