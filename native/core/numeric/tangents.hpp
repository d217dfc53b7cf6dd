// SPDX-License-Identifier: GPL-3.0-or-later
// Two directions that complete a unit vector to an orthonormal frame.
#pragma once
#include <array>
#include <cmath>

namespace lamina {

/// The two other axes of an orthonormal frame, by components x, y, z.
template <typename Real>
struct Tangents {
  std::array<Real, 3> first;
  std::array<Real, 3> second;
};

/// The frame of a unit vector, without a branch (Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017).
template <typename Real>
Tangents<Real> tangents_of(Real x, Real y, Real z) {
  const Real sign = std::copysign(Real(1), z);
  const Real a = Real(-1) / (sign + z);
  const Real b = x * y * a;
  return {{Real(1) + sign * x * x * a, sign * b, -sign * x}, {b, sign + y * y * a, -y}};
}

}  // namespace lamina
