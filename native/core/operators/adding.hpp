// SPDX-License-Identifier: GPL-3.0-or-later
// The adding equations for two scattering functions.
#pragma once
#include "operators/scattering_function.hpp"

namespace lamina {

/// Joins two scattering functions, `above` on top of `below`, with all orders of reflection between them:
///   R  = R1 + T1' R2 (1 - R1' R2)^-1 T1,
///   T  = T2 (1 - R1' R2)^-1 T1,
///   R' = R2' + T2 R1' (1 - R2 R1')^-1 T2'.
/// Joining a layer with itself is doubling (van de Hulst 1963; the series of Pharr and Hanrahan 2000).
inline ScatteringFunction join(const ScatteringFunction& above, const ScatteringFunction& below) {
  const DirectionOperator between = resolvent(above.reflect_below * below.reflect_above);
  const DirectionOperator downward = between * above.transmit;
  // T2 R1' (1 - R2 R1')^-1 = T2 (1 - R1' R2)^-1 R1'.
  const DirectionOperator upward = between * above.reflect_below;
  return {above.reflect_above + above.transmit.transposed() * (below.reflect_above * downward),
          below.transmit * downward, below.reflect_below + below.transmit * (upward * below.transmit.transposed())};
}

/// R alone, for `above` on top of an opaque surface with the reflection `below`.
inline DirectionOperator join_opaque(const ScatteringFunction& above, const DirectionOperator& below) {
  const DirectionOperator between = resolvent(above.reflect_below * below);
  return above.reflect_above + above.transmit.transposed() * (below * (between * above.transmit));
}

}  // namespace lamina
