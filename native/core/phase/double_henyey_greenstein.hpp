// SPDX-License-Identifier: GPL-3.0-or-later
// Two Henyey-Greenstein lobes.
#pragma once
#include <cstddef>
#include "phase/henyey_greenstein.hpp"
#include "phase/moment_decay.hpp"

namespace lamina {

/// Two lobes, usually one forward and one backward: weight HG(g1) + (1 - weight) HG(g2) (Irvine 1965), with g1 and g2
/// in (-1, 1) and weight in [0, 1].
struct DoubleHenyeyGreenstein {
  static constexpr const char* kKind = "double-hg";
  static constexpr std::size_t kParameters = 3;

  HenyeyGreenstein first;
  HenyeyGreenstein second;
  double weight = 1.0;

  DoubleHenyeyGreenstein(double g1, double g2, double weight_of_first)
      : first{g1}, second{g2}, weight(weight_of_first) {}

  double evaluate(double cosine) const { return mixed(first.evaluate(cosine), second.evaluate(cosine)); }
  double moment(int order) const { return mixed(first.moment(order), second.moment(order)); }
  double peak() const { return measured_peak(*this); }

  /// u chooses the lobe and, rescaled, the cosine.
  double sample(double u) const {
    if (u <= weight && weight > 0.0) {
      return first.sample(u / weight);
    }
    return second.sample((u - weight) / (1.0 - weight));
  }

 private:
  double mixed(double one, double other) const { return weight * one + (1.0 - weight) * other; }
};

}  // namespace lamina
