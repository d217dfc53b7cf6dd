// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/joined_media.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace lamina {

GradedMedium joined_media(const Stack& stack, bool endless) {
  const auto refuse = [](const char* what) {
    throw std::invalid_argument(std::string("the scattering equation's methods do not support ") + what +
                                ": must be finite media over nothing, black or a Lambert surface");
  };
  std::vector<GradedMedium::Knot> knots;
  const Medium* only = nullptr;
  double depth = 0.0;
  for (const Layer& layer : stack.layers) {
    if (const auto* boundary = std::get_if<Interface>(&layer)) {
      if (boundary->reflects(1.0)) {
        refuse("boundaries");
      }
    } else if (const auto* graded = std::get_if<GradedMedium>(&layer)) {
      for (GradedMedium::Knot knot : graded->knots()) {
        knot.tau += depth;
        knots.push_back(std::move(knot));
      }
      depth = knots.back().tau;
    } else {
      const auto& medium = std::get<Medium>(layer);
      if (std::isinf(medium.tau) && !endless) {
        refuse("infinitely thick media");
      }
      if (medium.tau > 0.0) {
        only = knots.empty() ? &medium : nullptr;
        knots.push_back({depth, medium.albedo, medium.phase});
        depth += medium.tau;
        knots.push_back({depth, medium.albedo, medium.phase});
      }
      if (std::isinf(medium.tau)) {
        break;
      }
    }
  }
  if (knots.empty()) {
    refuse("a stack without media");
  }
  if (!stack.base.is_none_or_lambert()) {
    refuse("this base");
  }
  const bool is_one = only != nullptr && knots.size() == 2;
  return (is_one ? GradedMedium::homogeneous(only->albedo, only->tau, only->phase)
                 : GradedMedium(GradedMedium::without_slivers(std::move(knots))))
      .over(stack.base.kind == Base::Kind::kLambert ? stack.base.reflectance : 0.0);
}

}  // namespace lamina
