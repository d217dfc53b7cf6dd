// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering function of a base without facets.
#pragma once
#include "matter/base.hpp"
#include "operators/directions.hpp"
#include "operators/scattering_function.hpp"

namespace lamina {

/// The specular reflection of an opaque base; no kernels. Zero for a base that has no mirror.
ScatteringFunction base_deltas(const Base& base, const Directions& above);

/// One azimuth order of the reflection of an opaque base, without the lobes of its facets. Rows are views.
ScatteringFunction base_reflection(const Base& base, int order, const Directions& above);

}  // namespace lamina
