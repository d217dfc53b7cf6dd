// SPDX-License-Identifier: GPL-3.0-or-later
// A stack with homogeneous sublayers in place of its graded layers.
#pragma once
#include <cstddef>
#include <vector>

#include "matter/stack.hpp"

namespace lamina {

/// A stack in which homogeneous sublayers stand for each graded layer.
struct SublayerStack {
  Stack stack;
  std::vector<std::size_t>
      first;                  ///< by layer of the stack as it was given: its first sublayer; at the end their count
  std::vector<double> share;  ///< by sublayer: of its layer's thickness

  /// `coarseness`, by layer: how finely a graded layer is divided, see sublayers_of; needed for graded layers only.
  SublayerStack(const Stack& given, const std::vector<double>& coarseness = {});
};

}  // namespace lamina
