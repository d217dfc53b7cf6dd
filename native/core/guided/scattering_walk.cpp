// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/scattering_walk.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "guided/guided_transfer_walk.hpp"
#include "guided/guided_walk.hpp"
#include "guided/isotropic_walk.hpp"
#include "guided/residual_walk.hpp"
#include "matter/joined_media.hpp"
#include "walks/plain_scattering_walk.hpp"
#include "walks/transfer_walk.hpp"

namespace lamina {
namespace {

/// Cost of a sample's first event and of each further event, in nanoseconds on one core. Measured; only ratios matter.
struct Cost {
  double first;
  double further;
};

struct Candidate {
  std::string name;
  Cost cost;
};

/// The walks that the pilot compares; the first is the fallback.
std::vector<Candidate> candidates(const GradedMedium& medium) {
  const bool both = fitted(NextEvent::kFitting, medium.at(0.0).p[0]) == NextEvent::kFromBothEnds;
  if (medium.is_homogeneous() && medium.ground() == 0.0) {
    return {{"transfer", both ? Cost{150.0, 118.0} : Cost{110.0, 70.0}},
            {"transfer-guided", {90.0, 1800.0}},
            {"residual-16", {320.0, 900.0}},
            {"residual-8", {290.0, 770.0}}};
  }
  if (medium.is_homogeneous()) {
    return {{"transfer", both ? Cost{110.0, 199.0} : Cost{115.0, 84.0}},
            {"guided-16", {200.0, 1000.0}},
            {"guided-32", {200.0, 1300.0}},
            {"guided-8", {220.0, 840.0}}};
  }
  return {{"transfer", {155.0, 84.0}},
          {"guided-16", {480.0, 1250.0}},
          {"guided-32", {510.0, 1610.0}},
          {"guided-8", {500.0, 1080.0}}};
}

std::unique_ptr<Walk> build(const GradedMedium& medium, double mu_o, double mu_i, double dphi, const std::string& name,
                            std::shared_ptr<const ScatteringGuide>& guide) {
  if (name == "plain") {
    return std::make_unique<PlainScatteringWalk>(medium, mu_o, mu_i, dphi);
  }
  if (name == "transfer") {
    const WalkTarget target{Side::kTop, Path::kReflect, mu_o, mu_i, dphi, false};
    return make_transfer_walk(stack_of(medium), target, NextEvent::kFitting);
  }
  if (name == "transfer-guided") {
    return make_guided_transfer_walk(medium, mu_o, mu_i, dphi);
  }
  if (name == "isotropic") {
    return std::make_unique<IsotropicWalk>(medium, mu_o, mu_i);
  }
  for (const int count : {8, 16, 32}) {
    if (name == "residual-" + std::to_string(count)) {
      if (!guide) {
        guide = std::make_shared<const ScatteringGuide>(medium);
      }
      return std::make_unique<ResidualWalk>(medium, mu_o, mu_i, dphi, count, guide);
    }
    if (name == "guided-" + std::to_string(count)) {
      if (!guide) {
        guide = std::make_shared<const ScatteringGuide>(medium);
      }
      return std::make_unique<GuidedWalk>(medium, mu_o, mu_i, dphi, count, guide);
    }
  }
  std::string known;
  for (const std::string& one : scattering_walk_names()) {
    known += (known.empty() ? "" : ", ") + one;
  }
  throw std::invalid_argument("walk = '" + name + "': must be one of " + known);
}

/// Relative variance of the mean times the cost of the samples.
double price(const Tally& tally, const Cost& cost) {
  const double n = static_cast<double>(tally.count);
  if (tally.sum <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const double relative = tally.standard_error() / tally.mean();
  const double further = static_cast<double>(tally.events) - n;
  return relative * relative * (cost.first * n + cost.further * further);
}

/// Adds samples of the pilot to the tally.
void draw_more(const Walk& walk, std::uint64_t seed, std::uint64_t samples, Tally& tally) {
  const std::uint64_t end = tally.count + samples;
  for (std::uint64_t k = tally.count; k < end; ++k) {
    Rng rng(seed, k);
    tally.add_sample(walk.sample(rng, tally.events));
  }
}

}  // namespace

std::vector<std::string> scattering_walk_names() {
  return {"auto",        "plain",       "guided-8",  "guided-16", "guided-32",      "residual-8",
          "residual-16", "residual-32", "isotropic", "transfer",  "transfer-guided"};
}

ScatteringWalk make_scattering_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi,
                                    const std::string& name, std::uint64_t seed) {
  std::shared_ptr<const ScatteringGuide> guide;
  ScatteringWalk chosen;
  if (name != "auto" || medium.is_isotropic()) {
    chosen.name = name == "auto" ? "isotropic" : name;
    chosen.walk = build(medium, mu_o, mu_i, dphi, chosen.name, guide);
    return chosen;
  }
  // Derive a seed that runs are unlikely to use.
  const std::uint64_t pilot_seed = seed ^ 0x9bd1e5b0c2f4a837U;
  double best = std::numeric_limits<double>::infinity();
  std::uint64_t spent_samples = 0;
  std::uint64_t spent_events = 0;
  const std::vector<Candidate> all = candidates(medium);
  for (const Candidate& candidate : all) {
    std::unique_ptr<Walk> walk = build(medium, mu_o, mu_i, dphi, candidate.name, guide);
    const bool fallback = candidate.name == all.front().name;
    // A short pilot may miss rare large samples of a guided walk, so a guided walk must be better by this factor.
    constexpr double kDoubt = 1.5;
    const auto cost_of = [&](const Tally& tally) {
      return price(tally, candidate.cost) * (fallback ? 1.0 / kDoubt : 1.0);
    };
    // After a few samples, drop walks whose price is this multiple of the best price.
    constexpr std::uint64_t kFew = 256;
    constexpr std::uint64_t kMany = 2048;
    constexpr double kHopeless = 4.0;
    Tally tally;
    draw_more(*walk, pilot_seed, kFew, tally);
    const bool hopeless = cost_of(tally) > kHopeless * best;
    if (!hopeless) {
      draw_more(*walk, pilot_seed, kMany - kFew, tally);
    }
    spent_samples += tally.count;
    spent_events += tally.events;
    const double found = cost_of(tally);
    if (found < best) {
      best = found;
      chosen.walk = std::move(walk);
      chosen.name = candidate.name;
    } else if (hopeless && chosen.name == all.front().name) {
      break;
    }
  }
  chosen.pilot_samples = spent_samples;
  chosen.pilot_events = spent_events;
  return chosen;
}

}  // namespace lamina
