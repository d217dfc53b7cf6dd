// SPDX-License-Identifier: GPL-3.0-or-later
#include "solution.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "adding.hpp"
#include "single_scattering.hpp"

namespace lamina {
namespace {

/// Below this thickness multiple scattering is less than 1e-5 of single scattering (it grows like
/// tau log tau), and rounding would show instead.
constexpr double kThinnest = 1e-6;

/// Orders solved between two looks at convergence; fixed, so that results do not depend on threads.
constexpr int kBlock = 4;

bool scatters_repeatedly(const TruncatedMedium& medium) { return medium.albedo > 0.0 && medium.tau > kThinnest; }

/// The smallest phase value over the azimuth, for light turned back between two directions.
double least_phase(const PhaseFunction& phase, double mu_o, double mu_i, double turn) {
  const double sines = std::sqrt((1.0 - mu_o * mu_o) * (1.0 - mu_i * mu_i));
  double least = phase.evaluate(turn * mu_o * mu_i - sines);
  for (const double azimuth : {-0.5, 0.0, 0.5, 1.0}) {
    least = std::min(least, phase.evaluate(turn * mu_o * mu_i + azimuth * sines));
  }
  return least;
}

}  // namespace

Solution::Solution(Stack stack, const Resolution& resolution, ThreadPool& pool)
    : stack_(std::move(stack)), resolution_(resolution), quadrature_(std::make_shared<Quadrature>(resolution.nodes)) {
  for (std::size_t i = 0; i < stack_.layers.size(); ++i) {
    modes_.push_back(std::make_shared<Modes>());
  }
  solve(pool);
}

Solution Solution::with_thickness(std::size_t layer, double tau, ThreadPool& pool) const {
  Solution other = *this;
  other.stack_.layers.at(layer).tau = tau;
  other.solve(pool);
  return other;
}

void Solution::solve(ThreadPool& pool) {
  multiple_.clear();
  media_.clear();
  checks_ = SolveChecks{};
  checks_.quadrature = quadrature_->moment_error();
  for (const Medium& medium : stack_.layers) {
    media_.emplace_back(medium, resolution_.moments());
  }
  const std::size_t layers = media_.size();
  for (int first = 0; first < resolution_.moments(); first += kBlock) {
    const int last = std::min(first + kBlock, resolution_.moments());
    multiple_.resize(static_cast<std::size_t>(last), std::vector<MultipleScattering>(layers));
    for (const auto& modes : modes_) {
      modes->resize(std::max(modes->size(), static_cast<std::size_t>(last)));
    }
    std::vector<SolveChecks> found(layers * static_cast<std::size_t>(last - first));
    pool.run(found.size(), [&](std::size_t task) {
      solve_layer(first + static_cast<int>(task / layers), task % layers, found[task]);
    });
    for (const SolveChecks& checks : found) {
      checks_.worsen(checks);
    }
    if (share_of_order(last - 1) + share_of_order(last - 2) < resolution_.azimuth_tolerance) {
      break;
    }
  }
}

void Solution::solve_layer(int order, std::size_t layer, SolveChecks& checks) {
  const TruncatedMedium& medium = media_[layer];
  MultipleScattering& multiple = multiple_[static_cast<std::size_t>(order)][layer];
  if (!scatters_repeatedly(medium)) {
    const Eigen::Index n = quadrature_->mu.size();
    multiple = {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
    return;
  }
  std::unique_ptr<HomogeneousModes>& modes = (*modes_[layer])[static_cast<std::size_t>(order)];
  if (!modes) {
    modes = std::make_unique<HomogeneousModes>(medium, order, *quadrature_);
  }
  const PhaseKernel phase(medium, order, quadrature_->mu);
  const HomogeneousModes::Layer solved = modes->layer(medium.tau);
  multiple = multiple_scattering(solved, medium, phase, order, *quadrature_);
  if (order == 0) {
    checks = check_layer(solved, multiple, phase, medium, *quadrature_);
  }
}

/// The largest share that an order has of the least that a layer sends anywhere: light scattered once
/// plus a part of the mean of the rest.
double Solution::share_of_order(int order) const {
  constexpr double kGrazing = 0.04;  // below it, values are not promised
  const Eigen::VectorXd& mu = quadrature_->mu;
  double share = 0.0;
  for (std::size_t layer = 0; layer < media_.size(); ++layer) {
    if (!scatters_repeatedly(media_[layer])) {
      continue;
    }
    const MultipleScattering& mean = multiple_.front()[layer];
    const MultipleScattering& wave = multiple_[static_cast<std::size_t>(order)][layer];
    const double quarter = 0.25 * media_[layer].single_scattering_albedo();
    for (Eigen::Index j = 0; j < mu.size(); ++j) {
      for (Eigen::Index i = 0; i <= j; ++i) {
        if (mu[i] < kGrazing) {
          continue;
        }
        const PhaseFunction& phase = stack_.layers[layer].phase;
        const double sines = order % 2 == 0 ? 1.0 : std::sqrt((1.0 - mu[i] * mu[i]) * (1.0 - mu[j] * mu[j]));
        const double back = quarter * least_phase(phase, mu[i], mu[j], -1.0) + 0.1 * mean.reflect(i, j);
        const double on = quarter * least_phase(phase, mu[i], mu[j], 1.0) + 0.1 * mean.transmit(i, j);
        share =
            std::max({share, std::abs(wave.reflect(i, j)) * sines / back, std::abs(wave.transmit(i, j)) * sines / on});
      }
    }
  }
  return share;
}

ScatteringFunction Solution::joined(const Directions& directions, int order) const {
  ScatteringFunction whole = ScatteringFunction::empty(directions);
  bool first = true;
  const auto append = [&](const ScatteringFunction& layer) {
    whole = first ? layer : join(whole, layer);
    first = false;
  };
  for (std::size_t layer = 0; layer < media_.size(); ++layer) {
    append(layer_on(directions, multiple_[static_cast<std::size_t>(order)][layer], media_[layer], order));
  }
  if (stack_.base.kind == Base::Kind::kLambert) {
    append(ScatteringFunction::lambert(stack_.base.reflectance, order, directions));
  }
  return whole;
}

ScatteringFunction Solution::without_single(const Directions& directions, int order) const {
  const bool base_reflects = stack_.base.kind == Base::Kind::kLambert && order == 0 && stack_.base.reflectance > 0;
  if (media_.size() == 1 && !base_reflects) {
    ScatteringFunction alone = multiple_on(directions, multiple_[static_cast<std::size_t>(order)][0], media_[0], order);
    if (stack_.base.kind == Base::Kind::kLambert) {
      alone.transmit.kernel.setZero();
    }
    return alone;
  }
  ScatteringFunction rest = joined(directions, order);
  rest.transmit.delta.setZero();
  for (std::size_t layer = 0; layer < media_.size(); ++layer) {
    ScatteringFunction single = single_on(directions, media_[layer], order);
    Eigen::VectorXd above = Eigen::VectorXd::Ones(directions.size());
    Eigen::VectorXd below = above;
    for (std::size_t other = 0; other < media_.size(); ++other) {
      if (other != layer) {
        Eigen::VectorXd& side = other < layer ? above : below;
        side = side.cwiseProduct(direct_transmissions(directions.mu, media_[other].tau));
      }
    }
    if (stack_.base.kind == Base::Kind::kLambert) {
      below.setZero();
    }
    rest.reflect_above.kernel -= above.asDiagonal() * single.reflect_above.kernel * above.asDiagonal();
    rest.reflect_below.kernel -= below.asDiagonal() * single.reflect_below.kernel * below.asDiagonal();
    rest.transmit.kernel -= below.asDiagonal() * single.transmit.kernel * above.asDiagonal();
  }
  return rest;
}

Solution solve(const Stack& stack, double tolerance, ThreadPool& pool) {
  Resolution resolution = choose_resolution(stack, tolerance);
  while (true) {
    Solution solution(stack, resolution, pool);
    const SolveChecks& checks = solution.checks();
    constexpr double kExact = 1e-9;
    constexpr double kEnergy = 5e-7;
    const bool sound = checks.quadrature < kExact && checks.phase < kEnergy && checks.energy < kEnergy &&
                       checks.reciprocity < kEnergy && checks.negativity < tolerance && checks.resolution < tolerance;
    if (sound) {
      return solution;
    }
    const Resolution finer = refined(resolution);
    if (finer.nodes == resolution.nodes) {
      std::ostringstream message;
      message << "the stack cannot be resolved: with " << resolution.nodes
              << " nodes per hemisphere the errors are quadrature " << checks.quadrature << ", phase " << checks.phase
              << ", energy " << checks.energy << ", reciprocity " << checks.reciprocity << ", negativity "
              << checks.negativity << ", resolution " << checks.resolution << " (allowed " << tolerance << ")";
      throw std::runtime_error(message.str());
    }
    resolution = finer;
  }
}

}  // namespace lamina
