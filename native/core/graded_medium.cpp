// SPDX-License-Identifier: GPL-3.0-or-later
#include "graded_medium.hpp"

#include <algorithm>
#include <stdexcept>

namespace lamina {

GradedMedium::GradedMedium(std::vector<Knot> knots) : knots_(std::move(knots)) {
  if (knots_.size() < 2 || knots_.front().tau != 0.0) {
    throw std::invalid_argument("knots: must be two at least, the first at tau = 0");
  }
  for (std::size_t k = 1; k < knots_.size(); ++k) {
    if (!(knots_[k].tau > knots_[k - 1].tau)) {
      throw std::invalid_argument("knots: tau must ascend");
    }
  }
  isotropic_ = std::all_of(knots_.begin(), knots_.end(), [](const Knot& knot) { return knot.phase.is_isotropic(); });
}

GradedMedium GradedMedium::homogeneous(double albedo, double tau, const PhaseFunction& phase) {
  GradedMedium medium({{0.0, albedo, phase}, {tau, albedo, phase}});
  medium.homogeneous_ = true;
  return medium;
}

LocalScattering GradedMedium::between(double t) const {
  const double depth = std::clamp(tau() - t, 0.0, tau());
  const auto below = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, depth,
                                      [](double value, const Knot& knot) { return value < knot.tau; });
  const auto above = below - 1;
  const double share = (depth - above->tau) / (below->tau - above->tau);
  return {(1.0 - share) * above->albedo, share * below->albedo, &above->phase, &below->phase};
}

}  // namespace lamina
