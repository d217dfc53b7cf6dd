// SPDX-License-Identifier: GPL-3.0-or-later
#include "sliced_stack.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "evaluation.hpp"
#include "graded_slices.hpp"
#include "solution.hpp"

namespace lamina {
namespace {

/// Of the tolerance, for slices.
constexpr double kShare = 0.4;
/// By how much less half the intervals err; measured: 9 to 15.
constexpr double kGain = 6.0;
constexpr double kCoarsest = 2.0;
constexpr int kHalvings = 6;

/// BRDF and BTDF, from both sides, of slices that stand for one layer.
std::vector<double> probe(const std::vector<Medium>& slices, ThreadPool& pool) {
  Resolution resolution;
  resolution.nodes = 16;
  resolution.azimuth_tolerance = 1e-4;
  double tau = 0.0;
  for (const Medium& slice : slices) {
    tau += slice.tau;
  }
  resolution.thinnest = std::clamp(tau, kThinnestResolved, 1.0);
  const Solution solution(Stack{{slices.begin(), slices.end()}, {}}, resolution, pool);
  const Eigen::VectorXd mu{{0.05, 0.2, 0.5, 1.0}};
  const Eigen::VectorXd dphi{{0.0, 1.8}};
  std::vector<double> values;
  for (const auto& [side, path] :
       {std::pair(Side::kTop, Path::kReflect), {Side::kBottom, Path::kReflect}, {Side::kTop, Path::kTransmit}}) {
    const std::vector<double> some = evaluate_grid(solution, side, path, mu, mu, dphi, pool);
    values.insert(values.end(), some.begin(), some.end());
  }
  return values;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kFaint = 1e-6;  // 1/sr: what less of it is worth
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double difference = std::abs(a[k] - b[k]) / (std::abs(b[k]) + kFaint);
    largest = difference <= largest ? largest : difference;  // not a number is larger than any
  }
  return largest;
}

std::vector<Medium> resolved_slices(const GradedMedium& medium, double tolerance, ThreadPool& pool) {
  std::vector<Medium> slices = slices_of(medium, kCoarsest);
  if (slices.size() == 1 || medium.largest_albedo() == 0.0) {
    return slices;
  }
  std::vector<double> values = probe(slices, pool);
  double coarseness = kCoarsest;
  double difference = std::numeric_limits<double>::infinity();
  for (int halving = 0; halving < kHalvings; ++halving) {
    coarseness *= 0.5;
    std::vector<Medium> finer = slices_of(medium, coarseness);
    std::vector<double> finer_values = probe(finer, pool);
    difference = largest_difference(values, finer_values);
    slices = std::move(finer);
    values = std::move(finer_values);
    if (difference <= kGain * kShare * tolerance) {
      return slices;
    }
  }
  std::ostringstream message;
  message << "the stack cannot be resolved: " << slices.size() << " slices of a graded layer differ by " << difference
          << " from half as many (allowed " << kGain * kShare * tolerance << ")";
  throw std::runtime_error(message.str());
}

}  // namespace

SlicedStack::SlicedStack(const Stack& given, double tolerance, ThreadPool& pool) {
  stack.base = given.base;
  double ior = 1.0;
  for (const Layer& layer : given.layers) {
    first.push_back(stack.layers.size());
    if (const auto* interface = std::get_if<Interface>(&layer)) {
      if (interface->ior == ior) {
        continue;
      }
      ior = interface->ior;
    }
    const auto* graded = std::get_if<GradedMedium>(&layer);
    if (graded == nullptr) {
      stack.layers.push_back(layer);
      share.push_back(1.0);
      continue;
    }
    for (const Medium& slice : resolved_slices(*graded, tolerance, pool)) {
      stack.layers.emplace_back(slice);
      share.push_back(slice.tau / graded->tau());
    }
  }
  first.push_back(stack.layers.size());
}

}  // namespace lamina
