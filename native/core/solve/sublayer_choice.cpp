// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/sublayer_choice.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "matter/graded_sublayers.hpp"
#include "solve/evaluation.hpp"
#include "solve/solution.hpp"

namespace lamina {
namespace {

/// Share of the error tolerance that the division into sublayers may use.
constexpr double kShare = 0.4;
/// Halving the intervals reduces the error at least by this factor; measured: 9 to 15.
constexpr double kGain = 6.0;
/// The first coarseness, and how often it is halved.
constexpr double kCoarsest = 2.0;
constexpr int kHalvings = 6;

/// BRDF and BTDF of the sublayers of one layer from both sides.
std::vector<double> probe(const std::vector<Medium>& sublayers, ThreadPool& pool) {
  Resolution resolution;
  resolution.nodes = 16;
  resolution.azimuth_tolerance = 1e-4;
  double tau = 0.0;
  for (const Medium& sublayer : sublayers) {
    tau += sublayer.tau;
  }
  resolution.thinnest = std::clamp(tau, kLeastDivision, 1.0);
  const Solution solution(SublayerStack(Stack{{sublayers.begin(), sublayers.end()}, {}}), resolution, pool);
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
  constexpr double kFaint = 1e-6;  // 1/sr; differences of fainter values are relative to this
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double difference = std::abs(a[k] - b[k]) / (std::abs(b[k]) + kFaint);
    largest = difference <= largest ? largest : difference;  // NaN counts as the largest
  }
  return largest;
}

double choose_coarseness(const GradedMedium& medium, double tolerance, ThreadPool& pool) {
  double coarseness = kCoarsest;
  std::vector<Medium> sublayers = sublayers_of(medium, coarseness);
  if (sublayers.size() == 1 || medium.largest_albedo() == 0.0) {
    return coarseness;
  }
  std::vector<double> values = probe(sublayers, pool);
  double difference = 0.0;
  for (int halving = 0; halving < kHalvings; ++halving) {
    coarseness *= 0.5;
    sublayers = sublayers_of(medium, coarseness);
    std::vector<double> finer_values = probe(sublayers, pool);
    difference = largest_difference(values, finer_values);
    values = std::move(finer_values);
    if (difference <= kGain * kShare * tolerance) {
      return coarseness;
    }
  }
  std::ostringstream message;
  message << "the stack cannot be resolved: " << sublayers.size() << " sublayers of a graded layer differ by "
          << difference << " from half as many (allowed " << kGain * kShare * tolerance << ")";
  throw std::runtime_error(message.str());
}

}  // namespace

SublayerStack resolved_sublayers(const Stack& stack, double tolerance, ThreadPool& pool) {
  std::vector<double> coarseness;
  for (const Layer& layer : stack.layers) {
    const auto* graded = std::get_if<GradedMedium>(&layer);
    coarseness.push_back(graded == nullptr ? kCoarsest : choose_coarseness(*graded, tolerance, pool));
  }
  return {stack, coarseness};
}

}  // namespace lamina
