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
ScatteringFunction join(const ScatteringFunction& above, const ScatteringFunction& below);

/// R alone, for `above` on top of an opaque surface with the reflection `below`.
DirectionOperator join_opaque(const ScatteringFunction& above, const DirectionOperator& below);

}  // namespace lamina
