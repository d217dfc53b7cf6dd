// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/adding.hpp"

namespace lamina {

ScatteringFunction join(const ScatteringFunction& above, const ScatteringFunction& below) {
  const Resolvent between(above.reflect_below * below.reflect_above);
  const DirectionOperator downward = between * above.transmit;
  // T2 R1' (1 - R2 R1')^-1 T2' = T2 (1 - R1' R2)^-1 R1' T2'.
  const DirectionOperator upward = between * (above.reflect_below * below.transmit.transposed());
  return {above.reflect_above + above.transmit.transposed() * (below.reflect_above * downward),
          below.transmit * downward, below.reflect_below + below.transmit * upward};
}

DirectionOperator join_opaque(const ScatteringFunction& above, const DirectionOperator& below) {
  const Resolvent between(above.reflect_below * below);
  return above.reflect_above + above.transmit.transposed() * (below * (between * above.transmit));
}

}  // namespace lamina
