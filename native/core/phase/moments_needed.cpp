// SPDX-License-Identifier: GPL-3.0-or-later
#include "phase/moments_needed.hpp"

#include <cstddef>
#include <numbers>
#include <vector>

namespace lamina {

int moments_needed(const PhaseFunction& phase, double tolerance, double faint,
                   const std::function<double(int)>& factor) {
  using Eigen::ArrayXd;
  constexpr Eigen::Index kAngles = 361;
  const ArrayXd cosines = ArrayXd::LinSpaced(kAngles, 0.0, std::numbers::pi).cos();
  ArrayXd allowed = cosines;
  phase.evaluate_all(allowed);
  allowed = tolerance * allowed.max(faint);
  // Legendre polynomials upwards, then the rest of the series downwards.
  std::vector<ArrayXd> terms;
  ArrayXd before = ArrayXd::Zero(kAngles);
  ArrayXd now = ArrayXd::Ones(kAngles);
  for (int l = 0; l <= kMostMoments; ++l) {
    terms.emplace_back((2.0 * l + 1.0) * phase.moment(l) * factor(l) * now);
    const ArrayXd next = ((2.0 * l + 1.0) * cosines * now - static_cast<double>(l) * before) / (l + 1.0);
    before = now;
    now = next;
  }
  ArrayXd rest = ArrayXd::Zero(kAngles);
  int needed = kMostMoments;
  while (needed > 0) {
    rest += terms[static_cast<std::size_t>(needed)];
    if ((rest.abs() > allowed).any()) {
      break;
    }
    --needed;
  }
  return needed;
}

}  // namespace lamina
