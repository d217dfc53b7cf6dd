// SPDX-License-Identifier: GPL-3.0-or-later
#include "resolution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace lamina {
namespace {

constexpr int kMostNodes = 160;
constexpr int kStep = 8;

int rounded_up(double nodes) { return static_cast<int>(std::ceil(nodes / kStep)) * kStep; }

}  // namespace

Resolution choose_resolution(const Stack& stack, double tolerance) {
  double peak = 0.0;
  double thinnest = 1.0;
  const auto scatter = [&](double albedo, const PhaseFunction& phase) {
    peak = std::max(peak, phase.peak());
    // What the finest nodes leave of the peak shows in the aureole, and spoils the faint light elsewhere.
    constexpr double kUnresolved = 1e-5;
    const double rest = albedo * std::abs(phase.moment(2 * kMostNodes));
    if (rest > kUnresolved) {
      std::ostringstream message;
      message << "the stack cannot be resolved: the peak of a phase function is too sharp, its moment "
              << 2 * kMostNodes << " is " << rest << ", must be below " << kUnresolved
              << " (Henyey-Greenstein: |g| up to .964)";
      throw std::runtime_error(message.str());
    }
  };
  const auto add_medium = [&](double tau) {
    if (tau > kThinnestRepeated) {
      thinnest = std::min(thinnest, tau);
    }
  };
  for (const Layer& layer : stack.layers) {
    const auto* medium = std::get_if<Medium>(&layer);
    if (medium != nullptr && medium->albedo > 0.0 && medium->tau > 0.0) {
      scatter(medium->albedo, medium->phase);
      add_medium(medium->tau);
    }
    // Of a graded layer its whole thickness counts: slices are resolved by what is joined, not each alone.
    const auto* graded = std::get_if<GradedMedium>(&layer);
    if (graded != nullptr && graded->largest_albedo() > 0.0) {
      for (const GradedMedium::Knot& knot : graded->knots()) {
        if (knot.albedo > 0.0) {
          scatter(knot.albedo, knot.phase);
        }
      }
      add_medium(graded->tau());
    }
  }
  // Measured: 32 nodes hold 1e-4 for peaks up to .8, and thin layers down to tau = .001 within 1e-3;
  // beyond that, |chi_2n| near 1e-3 of the tolerance keeps the error of truncation below it.
  const double smooth = tolerance < 5e-3 ? 32.0 : 16.0;
  const double peaked = peak > 0.0 ? std::log(1e-3 * tolerance) / (2.0 * std::log(peak)) : 0.0;
  Resolution resolution;
  resolution.nodes = std::clamp(rounded_up(std::max(smooth, peaked)), 16, kMostNodes);
  resolution.thinnest = thinnest;
  resolution.tolerance = tolerance;
  resolution.azimuth_tolerance = 0.03 * tolerance;
  return resolution;
}

int orders_for_lobes(const Stack& stack, double tolerance) {
  const std::vector<double> indices = refractive_indices(stack);
  // Widths of lobes in n sin(theta), which refraction keeps: of refracted and of reflected light.
  double refracted = std::numeric_limits<double>::infinity();
  double reflected = std::numeric_limits<double>::infinity();
  int mirrors = 0;
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    const auto* interface = std::get_if<Interface>(&stack.layers[layer]);
    const double above = indices[layer];
    const double below = indices[layer + 1];
    mirrors += above != below ? 1 : 0;
    if (interface != nullptr && interface->is_rough(above)) {
      refracted = std::min(refracted, std::abs(below - above) * interface->facets.alpha);
      reflected = std::min(reflected, 2.0 * std::min(above, below) * interface->facets.alpha);
    }
  }
  if (stack.base.kind == Base::Kind::kConductor) {
    ++mirrors;
    if (stack.base.facets.alpha > 0.0) {
      reflected = std::min(reflected, 2.0 * indices.back() * stack.base.facets.alpha);
    }
  }
  if (mirrors < 2 || std::isinf(reflected)) {
    return 0;
  }
  const double narrowest = std::min(reflected, refracted);
  // The spectrum of a GGX lobe of width w falls as exp(-w k); where that is too hopeful, the check of what is returned
  // asks for more. Lookup tables hold two lobes in a row by these orders, too, as well as the nodes can.
  constexpr double kResolved = 32.0;
  const double decay = 1.0 - std::log(std::min(tolerance, 1e-2));
  const double two = std::min(0.5 * decay / (2.0 * narrowest), kResolved);
  const double orders = std::max(decay / (2.0 * narrowest + reflected), two);
  return static_cast<int>(std::min(std::ceil(orders), static_cast<double>(kMostOrders)));
}

Resolution refined(const Resolution& resolution) {
  Resolution finer = resolution;
  finer.nodes = std::min(kMostNodes, rounded_up(1.4 * resolution.nodes));
  return finer;
}

}  // namespace lamina
