// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
namespace lamina {

/// Scatters equally into all directions.
struct Isotropic {
  double evaluate(double /*cosine*/) const { return 1.0; }
  double moment(int order) const { return order == 0 ? 1.0 : 0.0; }
  double peak() const { return 0.0; }
  double sample(double u) const { return 2.0 * u - 1.0; }
};

}  // namespace lamina
