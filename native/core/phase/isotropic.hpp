// SPDX-License-Identifier: GPL-3.0-or-later
// The isotropic phase function.
#pragma once
#include <cstddef>

namespace lamina {

/// Scatters equally in all directions.
struct Isotropic {
  static constexpr const char* kKind = "isotropic";
  static constexpr std::size_t kParameters = 0;

  double evaluate(double /*cosine*/) const { return 1.0; }
  double moment(int order) const { return order == 0 ? 1.0 : 0.0; }
  double peak() const { return 0.0; }
  double sample(double u) const { return 2.0 * u - 1.0; }
};

}  // namespace lamina
