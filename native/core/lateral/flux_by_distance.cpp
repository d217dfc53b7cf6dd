// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/flux_by_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numeric/bessel.hpp"

namespace lamina {

namespace {

constexpr std::size_t kBins = 1000;

}  // namespace

FluxByDistance::FluxByDistance(double scale, double farthest)
    : scale_(scale), step_(std::asinh(farthest / scale) / kBins), flux_(kBins, 0.0), within_(kBins + 1, 0.0) {
  for (std::size_t k = 0; k <= kBins; ++k) {
    edges_.push_back(scale_ * std::sinh(step_ * static_cast<double>(k)));
  }
}

std::size_t FluxByDistance::bin_of(double r) const {
  return std::min(static_cast<std::size_t>(std::asinh(r / scale_) / step_), kBins - 1);
}

void FluxByDistance::add(double low, double high, double flux) {
  const std::size_t first = bin_of(low);
  const std::size_t last = bin_of(high);
  if (first == last) {
    flux_[first] += flux;
    return;
  }
  const double by_distance = flux / (high - low);
  flux_[first] += by_distance * (edges_[first + 1] - low);
  for (std::size_t k = first + 1; k < last; ++k) {
    flux_[k] += by_distance * (edges_[k + 1] - edges_[k]);
  }
  flux_[last] += by_distance * (high - edges_[last]);
}

void FluxByDistance::normalise(double flux) {
  double sum = 0.0;
  for (const double one : flux_) {
    sum += one;
  }
  for (std::size_t k = 0; k < kBins; ++k) {
    flux_[k] = sum == 0.0 ? 0.0 : flux_[k] * flux / sum;
    within_[k + 1] = within_[k] + flux_[k];
  }
}

double FluxByDistance::at(double q) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < kBins; ++k) {
    sum += flux_[k] * bessel_j0(0.5 * q * (edges_[k] + edges_[k + 1]));
  }
  return sum;
}

double FluxByDistance::inside(double r) const {
  if (r >= edges_.back()) {
    return within_.back();
  }
  const std::size_t bin = bin_of(r);
  const double share = (r - edges_[bin]) / (edges_[bin + 1] - edges_[bin]);
  return within_[bin] + std::clamp(share, 0.0, 1.0) * flux_[bin];
}

double FluxByDistance::density(double r) const {
  constexpr double kAround = 0.03;  // relative to r
  return (inside((1.0 + kAround) * r) - inside((1.0 - kAround) * r)) / (4.0 * std::numbers::pi * kAround * r * r);
}

double FluxByDistance::moment(int power) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < kBins; ++k) {
    const double low = edges_[k];
    const double high = edges_[k + 1];
    const double mean = power == 1 ? 0.5 * (low + high) : (low * low + low * high + high * high) / 3.0;
    sum += flux_[k] * mean;
  }
  return sum;
}

}  // namespace lamina
