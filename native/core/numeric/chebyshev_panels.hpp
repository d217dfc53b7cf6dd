// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth functions of one variable, tabulated as piecewise Chebyshev polynomials.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <vector>

namespace lamina {

/// `Functions` functions on [0, high], in panels that are halved until the last two terms of the polynomials are below
/// `exact`.
template <std::size_t Functions>
class ChebyshevPanels {
 public:
  using Values = std::array<double, Functions>;

  ChebyshevPanels() = default;
  ChebyshevPanels(double high, double exact, const std::function<Values(double)>& values) {
    add(0.0, high, exact, values);
  }

  double at(std::size_t function, double x) const {
    const auto place = std::lower_bound(ends_.begin(), ends_.end() - 1, x);
    const auto panel = static_cast<std::size_t>(place - ends_.begin());
    const std::array<double, kTerms>& terms = panels_[panel][function];
    const double t = 2.0 * (2.0 * (x - starts_[panel]) / (ends_[panel] - starts_[panel]) - 1.0);
    double one = 0.0;  // Clenshaw's recurrence
    double two = 0.0;
    for (std::size_t n = kTerms - 1; n > 0; --n) {
      const double next = t * one - two + terms[n];
      two = one;
      one = next;
    }
    return 0.5 * t * one - two + terms[0];
  }

 private:
  static constexpr int kTerms = 16;
  static constexpr double kNarrowest = 1e-6;
  static constexpr std::size_t kMostPanels = 1024;

  void add(double low, double top, double allowed, const std::function<Values(double)>& values) {
    using std::numbers::pi;
    std::array<Values, kTerms> sampled;
    for (int k = 0; k < kTerms; ++k) {
      const double x = std::cos(pi * (k + 0.5) / kTerms);
      sampled[static_cast<std::size_t>(k)] = values(low + 0.5 * (x + 1.0) * (top - low));
    }
    std::array<std::array<double, kTerms>, Functions> panel{};
    bool exact = true;
    for (std::size_t f = 0; f < Functions; ++f) {
      for (int n = 0; n < kTerms; ++n) {
        double sum = 0.0;
        for (int k = 0; k < kTerms; ++k) {
          sum += sampled[static_cast<std::size_t>(k)][f] * std::cos(pi * n * (k + 0.5) / kTerms);
        }
        panel[f][static_cast<std::size_t>(n)] = (n == 0 ? 1.0 : 2.0) / kTerms * sum;
      }
      exact = exact && std::abs(panel[f][kTerms - 1]) + std::abs(panel[f][kTerms - 2]) < allowed;
    }
    if (!exact && top - low > kNarrowest && panels_.size() < kMostPanels) {
      const double middle = 0.5 * (low + top);
      add(low, middle, allowed, values);
      add(middle, top, allowed, values);
      return;
    }
    starts_.push_back(low);
    ends_.push_back(top);
    panels_.push_back(panel);
  }

  std::vector<double> ends_;  // the upper ends of the panels
  std::vector<double> starts_;
  std::vector<std::array<std::array<double, kTerms>, Functions>> panels_;
};

}  // namespace lamina
