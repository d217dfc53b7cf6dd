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

/// What the finest nodes leave of a peak shows in the aureole, and spoils the faint light elsewhere.
constexpr double kUnresolved = 1e-5;

/// Of the tolerance, what the moments left out may add to light scattered twice, beside isotropic light of 1.
constexpr double kNoise = 1.0;

/// Light scattered twice has the moments chi_l^2: those from `first` on add this to it where they add most, straight
/// on or straight back.
double left_out(const PhaseFunction& phase, int first) {
  double sum = 0.0;
  for (int l = first; l <= kMostMoments; ++l) {
    sum += (2.0 * l + 1.0) * phase.moment(l) * phase.moment(l);
  }
  return sum;
}

/// Whether the moments from `first` on are those of noise, which know nothing of each other, and not those of a peak,
/// which fall slowly (a peak straight back alternates their signs).
bool is_noise(const PhaseFunction& phase, int first) {
  double squares = 0.0;
  double products = 0.0;
  for (int l = first; l + 2 <= std::min(kMostMoments, first + 128); ++l) {
    squares += phase.moment(l) * phase.moment(l);
    products += phase.moment(l) * phase.moment(l + 2);
  }
  return squares > 0.0 && products < 0.5 * squares;
}

/// Whether nodes that resolve so many moments will do although those beyond are noise: they show in light scattered
/// once, which takes the phase function itself, and hardly in what is scattered again.
bool only_noise_beyond(const PhaseFunction& phase, double albedo, int moments, double tolerance) {
  return is_noise(phase, moments) && albedo * left_out(phase, moments) <= kNoise * tolerance;
}

void refuse(const PhaseFunction& phase, double rest) {
  constexpr int kLast = 2 * kMostNodes;
  std::ostringstream message;
  message << "the stack cannot be resolved: ";
  if (is_noise(phase, kLast)) {
    int count = 0;
    int largest = kLast;
    for (int l = kLast; l <= kMostMoments; ++l) {
      count += std::abs(phase.moment(l)) > kUnresolved ? 1 : 0;
      largest = std::abs(phase.moment(l)) > std::abs(phase.moment(largest)) ? l : largest;
    }
    message << "the moments of a phase function do not fall off, " << count << " of its moments " << kLast << " to "
            << kMostMoments << " are above " << kUnresolved << " and moment " << largest << " is "
            << phase.moment(largest) << "; values with less noise or farther apart can be resolved";
  } else {
    message << "the peak of a phase function is too sharp, its moment " << kLast << " is " << rest << ", must be below "
            << kUnresolved << " (Henyey-Greenstein: |g| up to .964)";
  }
  throw std::runtime_error(message.str());
}

/// Measured: 32 nodes hold 1e-4 for peaks up to .8, and thin layers down to tau = .001 within 1e-3.
int fewest_nodes(double tolerance) { return tolerance < 5e-3 ? 32 : 16; }

/// Beyond that, |chi_2n| near 1e-3 of the tolerance keeps the error of truncation below it.
int nodes_for(const PhaseFunction& phase, double albedo, double tolerance) {
  const double peak = phase.peak();
  const double peaked = peak > 0.0 ? std::log(1e-3 * tolerance) / (2.0 * std::log(peak)) : 0.0;
  const int fewest = fewest_nodes(tolerance);
  int nodes = std::clamp(rounded_up(peaked), fewest, kMostNodes);
  while (nodes > fewest && only_noise_beyond(phase, albedo, 2 * (nodes - kStep), tolerance)) {
    nodes -= kStep;
  }
  return nodes;
}

}  // namespace

Resolution choose_resolution(const Stack& stack, double tolerance) {
  int nodes = fewest_nodes(tolerance);
  double thinnest = 1.0;
  const auto scatter = [&](double albedo, const PhaseFunction& phase) {
    constexpr int kLast = 2 * kMostNodes;
    const double rest = albedo * std::abs(phase.moment(kLast));
    if (rest > kUnresolved && !only_noise_beyond(phase, albedo, kLast, tolerance)) {
      refuse(phase, rest);
    }
    nodes = std::max(nodes, nodes_for(phase, albedo, tolerance));
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
  Resolution resolution;
  resolution.nodes = nodes;
  resolution.thinnest = std::max(thinnest, kThinnestResolved);
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
