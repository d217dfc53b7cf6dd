// SPDX-License-Identifier: GPL-3.0-or-later
// The elements of a stack, with lengths.
#pragma once
#include <vector>

#include "lateral_walks/depth_scale.hpp"
#include "walks/walk_elements.hpp"

namespace lamina {

/// A stack with lengths in millimetres, as the transfer walk goes through it from above.
struct LateralWalkStack {
  WalkElements walked;
  std::vector<DepthScale> scales;  ///< by element
  /// Of a conservative medium without end, 0 elsewhere: WalkElements ends such a medium with a surface that returns all
  /// light, which stands for what lies below. Light that enters a conservative half-space with the directions of a
  /// Lambert surface leaves sideways with the transform 1 - spread q + O(q^2), spread = 4/3 transport lengths (the P1
  /// equations: a net flux D q per unit fluence, D a third of a transport length). So the surface displaces light by
  /// a distance of density spread / (2 pi (r^2 + spread^2)^(3/2)), whose transform exp(-spread q) has that slope.
  double spread = 0.0;

  /// `scales`: one per layer; those of interfaces are ignored. Throws std::invalid_argument.
  LateralWalkStack(const Stack& stack, std::vector<DepthScale> layer_scales);
};

}  // namespace lamina
