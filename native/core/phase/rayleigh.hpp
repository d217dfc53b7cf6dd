// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace lamina {

/// Rayleigh scattering of unpolarised light: 3/4 (1 + cos^2).
struct Rayleigh {
  double evaluate(double cosine) const { return 0.75 * (1.0 + cosine * cosine); }
  double moment(int order) const { return order == 0 ? 1.0 : order == 2 ? 0.1 : 0.0; }
  double peak() const { return 0.0; }
};

}  // namespace lamina
