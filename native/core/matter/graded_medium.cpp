// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/graded_medium.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "phase/phase_blend.hpp"

namespace lamina {

std::vector<GradedMedium::Knot> GradedMedium::without_slivers(std::vector<Knot> knots) {
  constexpr double kThinnest = 1e-12;  // of the whole thickness
  const double tau = knots.back().tau;
  const double thinnest = std::isinf(tau) ? 0.0 : kThinnest * tau;
  std::vector<Knot> kept;
  for (Knot& knot : knots) {
    if (!kept.empty() && knot.tau - kept.back().tau <= thinnest) {
      knot.tau = kept.back().tau;
    }
    if (kept.size() > 1 && kept[kept.size() - 2].tau == knot.tau) {
      kept.pop_back();
    }
    kept.push_back(std::move(knot));
  }
  if (kept.size() > 2 && kept[1].tau == 0.0) {
    kept.erase(kept.begin());
  }
  if (kept.size() > 2 && kept[kept.size() - 2].tau == kept.back().tau) {
    kept.pop_back();
  }
  kept.back().tau = tau;
  return kept;
}

GradedMedium::GradedMedium(std::vector<Knot> knots) {
  if (knots.size() < 2 || knots.front().tau != 0.0) {
    throw std::invalid_argument("knots: must be at least two, the first at tau = 0");
  }
  for (std::size_t k = 1; k < knots.size(); ++k) {
    const bool at_an_end = k == 1 || k == knots.size() - 1;
    if (!(at_an_end ? knots[k].tau > knots[k - 1].tau : knots[k].tau >= knots[k - 1].tau)) {
      throw std::invalid_argument("knots: tau must ascend");
    }
  }
  knots_ = without_slivers(std::move(knots));
  for (std::size_t k = 1; k < knots_.size(); ++k) {
    keeps_phase_.push_back(alike(knots_[k - 1].phase, knots_[k].phase));
  }
  isotropic_ = std::all_of(knots_.begin(), knots_.end(), [](const Knot& knot) { return knot.phase.is_isotropic(); });
}

GradedMedium GradedMedium::homogeneous(double albedo, double tau, const PhaseFunction& phase) {
  GradedMedium medium({{0.0, albedo, phase}, {tau, albedo, phase}});
  medium.homogeneous_ = true;
  return medium;
}

GradedMedium GradedMedium::over(double reflectance) const {
  GradedMedium medium = *this;
  medium.ground_ = reflectance;
  return medium;
}

GradedMedium GradedMedium::turned() const {
  std::vector<Knot> knots(knots_.rbegin(), knots_.rend());
  for (Knot& knot : knots) {
    knot.tau = tau() - knot.tau;
  }
  GradedMedium medium(std::move(knots));
  medium.homogeneous_ = homogeneous_;
  return medium;
}

std::vector<double> GradedMedium::inner_heights() const {
  std::vector<double> heights;
  for (std::size_t k = knots_.size() - 1; k-- > 1;) {
    heights.push_back(tau() - knots_[k].tau);
  }
  return heights;
}

double GradedMedium::largest_albedo() const {
  const auto less = [](const Knot& a, const Knot& b) { return a.albedo < b.albedo; };
  return std::max_element(knots_.begin(), knots_.end(), less)->albedo;
}

const PhaseFunction& GradedMedium::sharpest_phase() const {
  const auto less = [](const Knot& a, const Knot& b) {
    return a.albedo * std::abs(a.phase.moment(1)) < b.albedo * std::abs(b.phase.moment(1));
  };
  return std::max_element(knots_.begin(), knots_.end(), less)->phase;
}

LocalScattering GradedMedium::at_depth(double depth) const {
  const auto below = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, std::clamp(depth, 0.0, tau()),
                                      [](double value, const Knot& knot) { return value < knot.tau; });
  const auto above = below - 1;
  const double share = std::clamp((depth - above->tau) / (below->tau - above->tau), 0.0, 1.0);
  const double upper = (1.0 - share) * above->albedo;
  const double lower = share * below->albedo;
  if (keeps_phase_[static_cast<std::size_t>(above - knots_.begin())]) {
    return {upper + lower, 0.0, &above->phase, &above->phase};
  }
  return {upper, lower, &above->phase, &below->phase};
}

}  // namespace lamina
