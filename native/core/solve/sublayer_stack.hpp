// SPDX-License-Identifier: GPL-3.0-or-later
// A stack with homogeneous sublayers in place of its graded layers.
#pragma once
#include <cstddef>
#include <vector>

#include "matter/stack.hpp"

namespace lamina {

/// A stack in which homogeneous sublayers replace each graded layer.
struct SublayerStack {
  Stack stack;
  std::vector<std::size_t> first;  ///< by layer of the given stack: its first sublayer; then the number of sublayers
  std::vector<double> share;       ///< by sublayer: its share of the layer's thickness

  /// `coarseness` by layer, see sublayers_of; used for graded layers only.
  SublayerStack(const Stack& given, const std::vector<double>& coarseness = {});
};

}  // namespace lamina
