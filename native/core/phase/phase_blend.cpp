// SPDX-License-Identifier: GPL-3.0-or-later
#include "phase/phase_blend.hpp"

#include <algorithm>
#include <type_traits>
#include <variant>

namespace lamina {
namespace {

template <typename Phase>
bool equal_values(const Phase& a, const Phase& b) {
  for (const double cosine : {-1.0, -0.7, -0.2, 0.1, 0.6, 0.9, 1.0}) {
    if (a.evaluate(cosine) != b.evaluate(cosine)) {
      return false;
    }
  }
  for (int l = 1; l <= 12; ++l) {
    if (a.moment(l) != b.moment(l)) {
      return false;
    }
  }
  return true;
}

bool alike(const SinglePhase& a, const SinglePhase& b) {
  return a.index() == b.index() &&
         std::visit([&](const auto& p) { return equal_values(p, std::get<std::decay_t<decltype(p)>>(b)); }, a);
}

}  // namespace

bool alike(const PhaseFunction& a, const PhaseFunction& b) {
  const auto kind = [](const PhaseFunction& phase) {
    return phase.visit([](const auto& p) { return PhaseFunction::Kind(p).index(); });
  };
  return kind(a) == kind(b) && equal_values(a, b);
}

PhaseFunction blend(const std::vector<std::pair<double, const PhaseFunction*>>& weighted) {
  std::vector<Mixture::Part> parts;
  const auto add = [&](double weight, const SinglePhase& phase) {
    if (weight <= 0.0) {
      return;
    }
    const auto known =
        std::find_if(parts.begin(), parts.end(), [&](const Mixture::Part& part) { return alike(part.phase, phase); });
    if (known == parts.end()) {
      parts.push_back({weight, phase});
    } else {
      known->share += weight;
    }
  };
  for (const auto& entry : weighted) {
    const double weight = entry.first;
    entry.second->visit([&](const auto& phase) {
      if constexpr (std::is_same_v<std::decay_t<decltype(phase)>, Mixture>) {
        for (const Mixture::Part& part : phase.parts()) {
          add(weight * part.share, part.phase);
        }
      } else {
        add(weight, SinglePhase(phase));
      }
    });
  }
  if (parts.size() == 1) {
    return std::visit([](const auto& phase) { return PhaseFunction(PhaseFunction::Kind(phase)); }, parts[0].phase);
  }
  return PhaseFunction(PhaseFunction::Kind(Mixture(std::move(parts))));
}

}  // namespace lamina
