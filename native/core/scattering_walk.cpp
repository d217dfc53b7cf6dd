// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering_walk.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "guided_walk.hpp"
#include "isotropic_walk.hpp"
#include "joined_media.hpp"
#include "photon_walk.hpp"
#include "plain_scattering_walk.hpp"
#include "transfer_walk.hpp"

namespace lamina {
namespace {

/// Cost of a sample and of each of its events, in nanoseconds of one processor: measured, and only their ratios
/// matter.
struct Cost {
  double sample;
  double event;
};

struct Candidate {
  std::string name;
  Cost cost;
};

const std::vector<Candidate>& candidates() {
  static const std::vector<Candidate> all = {{"photon", {35.0, 55.0}},
                                             {"guided-16", {50.0, 650.0}},
                                             {"guided-32", {50.0, 900.0}},
                                             {"guided-8", {50.0, 560.0}}};
  return all;
}

std::unique_ptr<Walk> build(const GradedMedium& medium, double mu_o, double mu_i, double dphi, const std::string& name,
                            std::shared_ptr<const ScatteringGuide>& guide) {
  if (name == "plain") {
    return std::make_unique<PlainScatteringWalk>(medium, mu_o, mu_i, dphi);
  }
  if (name == "photon" && (medium.ground() > 0.0 || !medium.is_homogeneous())) {
    const WalkTarget target{Side::kTop, Path::kReflect, mu_o, mu_i, dphi, false};
    return make_transfer_walk(stack_of(medium), target, NextEvent::kFitting);
  }
  if (name == "photon") {
    return std::make_unique<PhotonWalk>(medium, mu_o, mu_i, dphi);
  }
  if (name == "isotropic") {
    return std::make_unique<IsotropicWalk>(medium, mu_o, mu_i);
  }
  for (const int count : {8, 16, 32}) {
    if (name == "guided-" + std::to_string(count)) {
      if (!guide) {
        guide = std::make_shared<const ScatteringGuide>(medium);
      }
      return std::make_unique<GuidedWalk>(medium, mu_o, mu_i, dphi, count, guide);
    }
  }
  throw std::invalid_argument("walk = '" + name +
                              "': must be auto, plain, guided-8, guided-16, guided-32, isotropic or photon");
}

/// Relative variance times cost.
double price(const Tally& tally, const Cost& cost) {
  const double n = static_cast<double>(tally.count);
  if (tally.sum <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const double relative = tally.standard_error() / tally.mean();
  return relative * relative * n * (cost.sample + cost.event * static_cast<double>(tally.events) / n);
}

Tally pilot(const Walk& walk, std::uint64_t seed) {
  constexpr std::uint64_t kSamples = 2048;
  Tally tally;
  tally.count = kSamples;
  for (std::uint64_t k = 0; k < kSamples; ++k) {
    Rng rng(seed, k);
    const double value = walk.sample(rng, tally.events);
    tally.sum += value;
    tally.squares += value * value;
    tally.largest = std::max(tally.largest, value);
  }
  return tally;
}

}  // namespace

std::vector<std::string> scattering_walk_names() {
  return {"auto", "plain", "guided-8", "guided-16", "guided-32", "isotropic", "photon"};
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
  // A number far from those that the run itself is likely to begin with.
  const std::uint64_t pilot_seed = seed ^ 0x9bd1e5b0c2f4a837U;
  double best = std::numeric_limits<double>::infinity();
  std::uint64_t spent_samples = 0;
  std::uint64_t spent_events = 0;
  for (const Candidate& candidate : candidates()) {
    std::unique_ptr<Walk> walk = build(medium, mu_o, mu_i, dphi, candidate.name, guide);
    const Tally tally = pilot(*walk, pilot_seed);
    spent_samples += tally.count;
    spent_events += tally.events;
    // A guided walk's rare large samples hide in a short pilot: it must win clearly against the photon walk.
    constexpr double kDoubt = 2.0;
    const double found = price(tally, candidate.cost) * (candidate.name == "photon" ? 1.0 / kDoubt : 1.0);
    if (found < best) {
      best = found;
      chosen.walk = std::move(walk);
      chosen.name = candidate.name;
    } else if (chosen.name == "photon" && found > 10.0 * best) {
      break;
    }
  }
  chosen.pilot_samples = spent_samples;
  chosen.pilot_events = spent_events;
  return chosen;
}

}  // namespace lamina
