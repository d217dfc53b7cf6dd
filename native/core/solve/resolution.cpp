// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/resolution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "phase/moments_needed.hpp"

namespace lamina {
namespace {

/// Largest number of nodes per hemisphere; time grows with its cube. Numbers of nodes are multiples of kStep.
constexpr int kMostNodes = 160;
constexpr int kStep = 8;

int rounded_up(double nodes) { return static_cast<int>(std::ceil(nodes / kStep)) * kStep; }

/// Largest moment that the finest nodes may leave unresolved. It adds errors to the aureole and to faint light.
constexpr double kUnresolved = 1e-5;

/// True if the moments from `first` on are noise. Noise moments are uncorrelated; those of a peak decay slowly (with
/// alternating signs for a backward peak).
bool is_noise(const PhaseFunction& phase, int first) {
  double squares = 0.0;
  double products = 0.0;
  for (int l = first; l + 2 <= std::min(kMostMoments, first + 128); ++l) {
    squares += phase.moment(l) * phase.moment(l);
    products += phase.moment(l) * phase.moment(l + 2);
  }
  return squares > 0.0 && products < 0.5 * squares;
}

/// The number of nodes that resolve light scattered twice, at all angles. The moments of this light are the squares of
/// those of the phase function, so the small moments of noise hardly count. Quadrature with n nodes is exact for
/// products of two moments up to n.
int nodes_for_twice(const PhaseFunction& phase, double albedo, double tolerance) {
  constexpr double kShare = 0.5;   // of the tolerance
  constexpr double kFaint = 0.02;  // smaller values may have the error of this one
  return rounded_up(moments_needed(phase, kShare * tolerance, kFaint, [&](int l) { return albedo * phase.moment(l); }));
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

/// Measured: with 32 nodes the error is below 1e-4 for peaks up to .8, and below 1e-3 for layers down to tau = .001.
int fewest_nodes(double tolerance) { return tolerance < 5e-3 ? 32 : 16; }

/// For sharper peaks, |chi_2n| of about 1e-3 of the tolerance keeps the truncation error below the tolerance.
int nodes_for(const PhaseFunction& phase, double albedo, double tolerance) {
  const double peak = phase.peak();
  const double peaked = peak > 0.0 ? std::log(1e-3 * tolerance) / (2.0 * std::log(peak)) : 0.0;
  const int fewest = fewest_nodes(tolerance);
  const int nodes = rounded_up(peaked);
  return nodes <= fewest ? fewest
                         : std::clamp(std::min(nodes, nodes_for_twice(phase, albedo, tolerance)), fewest, kMostNodes);
}

/// Measured: the error of light that flakes scatter repeatedly is then below a tenth of the tolerance.
int nodes_for(const Flakes& flakes, double tolerance) {
  const double narrowness = std::max(1.0 / flakes.alpha, 0.6 * flakes.alpha);
  return std::clamp(rounded_up((tolerance < 5e-3 ? 4.8 : 3.6) * narrowness), fewest_nodes(tolerance), kMostNodes);
}

/// A boundary that reflects light, smooth or rough.
struct Reflector {
  double alpha;
  double refracted;  ///< width of a refracted lobe in n sin(theta); infinite if there is none
  double reflected;  ///< width of a reflected lobe in n sin(theta)
  double depth;      ///< optical thickness above the boundary
};

std::vector<Reflector> reflectors_of(const Stack& stack) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const std::vector<double> indices = refractive_indices(stack);
  std::vector<Reflector> found;
  double depth = 0.0;
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    const double above = indices[layer];
    const double below = indices[layer + 1];
    if (const auto* medium = std::get_if<Medium>(&stack.layers[layer])) {
      depth += medium->tau;
    } else if (const auto* graded = std::get_if<GradedMedium>(&stack.layers[layer])) {
      depth += graded->tau();
    } else if (const auto& interface = std::get<Interface>(stack.layers[layer]); interface.reflects(above)) {
      const double alpha = interface.facets.alpha;
      found.push_back({alpha, std::abs(below - above) * alpha, 2.0 * std::min(above, below) * alpha, depth});
    }
  }
  if (stack.base.is_glossy()) {
    const double alpha = stack.base.facets.alpha;
    found.push_back({alpha, kNone, 2.0 * indices.back() * alpha, depth});
  }
  return found;
}

/// Lobes of rough boundaries between which light passes unscattered: the azimuth orders for three successive lobes, and
/// the narrowest facets.
struct LobeChain {
  double orders = 0.0;
  double alpha = 0.0;
};

LobeChain slowest_chain(const Stack& stack, double tolerance) {
  const std::vector<Reflector> reflectors = reflectors_of(stack);
  const double wanted = 1.0 - std::log(std::min(tolerance, 1e-2));
  double refracted = std::numeric_limits<double>::infinity();
  double reflected = std::numeric_limits<double>::infinity();
  double decay = 0.0;
  LobeChain chain;
  for (std::size_t k = 0; k < reflectors.size(); ++k) {
    const Reflector& own = reflectors[k];
    // Light of three successive lobes crosses the media between the boundaries twice, which attenuates it.
    double gap = std::numeric_limits<double>::infinity();
    if (k > 0) {
      gap = own.depth - reflectors[k - 1].depth;
    }
    if (k + 1 < reflectors.size()) {
      gap = std::min(gap, reflectors[k + 1].depth - own.depth);
    }
    if (!(own.alpha > 0.0 && wanted - 2.0 * gap > 0.0)) {
      continue;
    }
    decay = std::max(decay, wanted - 2.0 * gap);
    refracted = std::min(refracted, own.refracted);
    reflected = std::min(reflected, own.reflected);
    chain.alpha = chain.alpha > 0.0 ? std::min(chain.alpha, own.alpha) : own.alpha;
  }
  if (decay == 0.0) {
    return chain;
  }
  const double narrowest = std::min(reflected, refracted);
  // The spectrum of a GGX lobe of width w decays as exp(-w k). If this estimate is too low, the check of returned
  // values requests more orders. Lookup tables use these orders for two successive lobes too, as far as the nodes
  // resolve them.
  constexpr double kResolved = 32.0;
  const double two = std::min(0.5 * decay / (2.0 * narrowest), kResolved);
  chain.orders = std::max(decay / (2.0 * narrowest + reflected), two);
  return chain;
}

/// Throws if the lobes need more azimuth orders than allowed. The estimate may be too large by a factor of 2.
void refuse_needles(const Stack& stack, double tolerance) {
  const LobeChain chain = slowest_chain(stack, tolerance);
  if (chain.orders > 2.0 * kMostOrders) {
    std::ostringstream message;
    message << "the stack cannot be resolved: facets of alpha " << chain.alpha
            << " send narrow lobes to another boundary and get them back, which takes about " << std::ceil(chain.orders)
            << " azimuth orders (at most " << kMostOrders << "); wider facets, or alpha 0, can be resolved";
    throw std::runtime_error(message.str());
  }
}

/// The resolution for the phase functions and thicknesses of the stack's media.
Resolution resolution_of_media(const Stack& stack, double tolerance) {
  int nodes = fewest_nodes(tolerance);
  double thinnest = 1.0;
  bool flakes = false;
  const auto resolve = [&](double albedo, const PhaseFunction& phase) {
    constexpr int kLast = 2 * kMostNodes;
    const double rest = albedo * std::abs(phase.moment(kLast));
    if (rest > kUnresolved && nodes_for_twice(phase, albedo, tolerance) > kMostNodes) {
      refuse(phase, rest);
    }
    nodes = std::max(nodes, nodes_for(phase, albedo, tolerance));
  };
  // Single scattering uses the phase function itself. Only multiple scattering needs nodes.
  const double least = thickest_unresolved(tolerance);
  for (const Layer& layer : stack.layers) {
    const auto* medium = std::get_if<Medium>(&layer);
    if (medium != nullptr && medium->flakes && medium->albedo > 0.0) {
      flakes = true;
      nodes = std::max(nodes, nodes_for(*medium->flakes, tolerance));
    }
    if (medium != nullptr && medium->albedo > 0.0 && medium->tau > least) {
      resolve(medium->albedo, medium->phase);
      thinnest = std::min(thinnest, medium->tau);
    }
    // The total thickness of a graded layer counts: single sublayers need not be resolved.
    const auto* graded = std::get_if<GradedMedium>(&layer);
    if (graded != nullptr && graded->largest_albedo() > 0.0 && graded->tau() > least) {
      for (const GradedMedium::Knot& knot : graded->knots()) {
        if (knot.albedo > 0.0) {
          resolve(knot.albedo, knot.phase);
        }
      }
      thinnest = std::min(thinnest, graded->tau());
    }
  }
  Resolution resolution;
  resolution.nodes = nodes;
  resolution.thinnest = std::max(thinnest, kLeastDivision);
  resolution.tolerance = tolerance;
  // The orders of flakes fall off smoothly, and their returned values are checked.
  resolution.azimuth_tolerance = (flakes ? 1.0 : 0.03) * tolerance;
  return resolution;
}

}  // namespace

Resolution choose_resolution(const Stack& stack, double tolerance) {
  refuse_needles(stack, tolerance);
  return resolution_of_media(stack, tolerance);
}

Resolution choose_mean_resolution(const Stack& stack, double tolerance) {
  Resolution resolution = resolution_of_media(stack, tolerance);
  resolution.only_mean = true;
  // The checks of returned values need all azimuth orders.
  resolution.tolerance = std::numeric_limits<double>::infinity();
  return resolution;
}

int orders_for_lobes(const Stack& stack, double tolerance) {
  const LobeChain chain = slowest_chain(stack, tolerance);
  return static_cast<int>(std::min(std::ceil(chain.orders), static_cast<double>(kMostOrders)));
}

Resolution refined(const Resolution& resolution) {
  Resolution finer = resolution;
  finer.nodes = std::min(kMostNodes, rounded_up(1.4 * resolution.nodes));
  return finer;
}

}  // namespace lamina
