// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "medium.hpp"

namespace lamina {

/// What lies below the last layer.
struct Base {
  enum class Kind { kNone, kLambert };
  Kind kind = Kind::kNone;   ///< none: a thin sheet, light leaves at the bottom
  double reflectance = 0.0;  ///< of a Lambert surface, [0, 1]
};

/// One channel of a stack, top layer first. A half-space is a last layer of infinite thickness.
struct Stack {
  std::vector<Medium> layers;
  Base base;
};

}  // namespace lamina
