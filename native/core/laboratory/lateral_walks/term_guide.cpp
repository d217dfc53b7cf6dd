// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral_walks/term_guide.hpp"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

constexpr double kMostPeak = 0.99;
constexpr double kMostReturned = 3.0;
constexpr double kLeast = 0.0125;  ///< least probability of a term: bounds the weights where the estimate is poor

}  // namespace

TermGuide::TermGuide(const GradedMedium& medium)
    : medium_(medium), peak_(std::clamp(medium.sharpest_phase().moment(1), 0.0, kMostPeak)) {}

TermGuide::Shares TermGuide::terms(double mu_a, double mu_b, double depth, double once, double albedo) const {
  const double left = medium_.tau() - depth;
  const double w = albedo * peak_ * -std::expm1(-(1.0 / mu_a + 1.0 / mu_b) * left);
  const double after_a = returned(mu_a, depth, albedo);
  const double after_b = returned(mu_b, depth, albedo);
  const double k0 = albedo * (1.0 - peak_);
  const double peak = w / (1.0 - w) * k0 * (1.0 + after_a) * (1.0 + after_b);
  const double to_a = mu_b / (mu_a + mu_b);
  const double on_a = k0 * after_b + peak * to_a;
  const double on_b = k0 * after_a + peak * (1.0 - to_a);
  const double on_both = k0 * after_a * after_b;
  const double total = once + on_a + on_b + on_both;
  const auto share = [total](double term) {
    return kLeast + (1.0 - 4.0 * kLeast) * (total > 0.0 ? term / total : 0.25);
  };
  return {share(on_a), share(on_b), share(on_both)};
}

double TermGuide::ground(double mu_a, double mu_b, double depth, double from_ground) const {
  const double albedo = medium_.at_depth(depth).albedo();
  const double once = -std::expm1(-(1.0 / mu_a + 1.0 / mu_b) * (medium_.tau() - depth)) * albedo;
  const double from_media = once * (1.0 + returned(mu_a, depth, albedo)) * (1.0 + returned(mu_b, depth, albedo));
  const double both = from_ground + from_media;
  return both > 0.0 ? std::clamp(from_ground / both, kLeast, 1.0 - kLeast) : 0.5;
}

double TermGuide::before(double mu, double depth, double albedo) const {
  const double x = returned(mu, depth, albedo);
  return std::max(kLeast, (1.0 - peak_ * albedo) * x / (1.0 + x));
}

double TermGuide::returned(double mu, double depth, double albedo) const {
  const double peak = albedo * peak_;
  const double gamma = std::sqrt((1.0 - albedo) / (1.0 - peak));
  const double left = medium_.tau() - depth;
  const double media = 2.0 * mu * (1.0 - gamma) / (1.0 + 2.0 * mu * gamma) * -std::expm1(-left * (1.0 - peak) / mu);
  // A Lambert surface: 2 mu exp(-left / mu) E_2(left) per unit of reflectance.
  const double lit = medium_.ground() > 0.0 ? std::exp(-left / mu - left) / (1.0 + 0.5 * left) : 0.0;
  return std::min(kMostReturned, media + 2.0 * mu * medium_.ground() * lit);
}

}  // namespace lamina
