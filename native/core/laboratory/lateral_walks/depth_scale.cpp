// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral_walks/depth_scale.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lamina {

DepthScale::DepthScale(std::vector<Knot> knots) : knots_(std::move(knots)) {
  if (knots_.size() < 2) {
    throw std::invalid_argument("depth knots: must be at least two");
  }
  for (std::size_t k = 1; k < knots_.size(); ++k) {
    if (!(knots_[k].tau >= knots_[k - 1].tau && knots_[k].depth >= knots_[k - 1].depth)) {
      throw std::invalid_argument("depth knots: tau and depth must not decrease");
    }
  }
  uniform_ = knots_.size() == 2 && knots_[0].sigma_t == knots_[1].sigma_t && knots_[0].sigma_t > 0.0;
}

DepthScale DepthScale::joined(const std::vector<DepthScale>& scales) {
  if (scales.size() == 1) {
    return scales.front();
  }
  std::vector<Knot> knots;
  for (const DepthScale& scale : scales) {
    const Knot above = knots.empty() ? Knot{} : knots.back();
    for (const Knot& knot : scale.knots_) {
      knots.push_back({above.tau + knot.tau, above.depth + knot.depth, knot.sigma_t});
    }
  }
  return DepthScale(std::move(knots));
}

DepthScale::Place DepthScale::at(double tau) const {
  if (uniform_) {
    return {tau / knots_[0].sigma_t, knots_[0].sigma_t, 0};
  }
  if (tau <= 0.0) {
    return top();
  }
  if (tau >= knots_.back().tau) {
    return bottom();
  }
  const auto below = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, tau,
                                      [](double value, const Knot& knot) { return value < knot.tau; });
  const auto above = below - 1;
  const double way = tau - above->tau;
  const double square = above->sigma_t * above->sigma_t;
  const double slope = (below->sigma_t * below->sigma_t - square) / (below->tau - above->tau);
  const double sigma_t = std::sqrt(std::max(0.0, square + slope * way));
  const double depth = way > 0.0 ? above->depth + 2.0 * way / (above->sigma_t + sigma_t) : above->depth;
  return {depth, sigma_t, static_cast<std::size_t>(above - knots_.begin())};
}

double DepthScale::length(const Place& from, const Place& to, double optical, double mu) const {
  if (uniform_) {
    return optical / knots_[0].sigma_t;
  }
  const double sum = from.sigma_t + to.sigma_t;
  if (from.piece == to.piece && sum > 0.0) {
    return 2.0 * optical / sum;
  }
  constexpr double kLeastCosine = 1e-12;
  return std::abs(to.depth - from.depth) / std::max(mu, kLeastCosine);
}

}  // namespace lamina
