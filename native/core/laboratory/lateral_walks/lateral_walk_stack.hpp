// SPDX-License-Identifier: GPL-3.0-or-later
// The elements of a stack for walks, with lengths.
#pragma once
#include <vector>

#include "lateral_walks/depth_scale.hpp"
#include "walks/walk_elements.hpp"

namespace lamina {

/// A stack with lengths in millimetres, in the elements of the transfer walk from above.
struct LateralWalkStack {
  WalkElements walked;
  std::vector<DepthScale> scales;  ///< by element
  /// Nonzero for a conservative half-space only. WalkElements ends such a half-space with a surface that returns all
  /// light, in place of the medium below. Light that enters a conservative half-space with the directions of a Lambert
  /// surface leaves with the lateral transform 1 - spread q + O(q^2), spread = 4/3 transport lengths (the P1 equations:
  /// a net flux D q per unit fluence, D a third of a transport length). The surface therefore displaces light by a
  /// distance with the density spread / (2 pi (r^2 + spread^2)^(3/2)), whose transform exp(-spread q) has the same
  /// slope.
  double spread = 0.0;

  /// `scales`: one per layer; entries of interfaces are ignored. Throws std::invalid_argument for another number of
  /// entries.
  LateralWalkStack(const Stack& stack, std::vector<DepthScale> layer_scales);
};

}  // namespace lamina
