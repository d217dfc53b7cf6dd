// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral_walks/searchlight_tally.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/bessel.hpp"
#include "walks/walk_blocks.hpp"

namespace lamina {
namespace {

constexpr std::size_t kPowers = 3;  ///< weight times 1, r, r^2

void add_all(std::vector<double>& sums, const std::vector<double>& others) {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    sums[k] += others[k];
  }
}

}  // namespace

SearchlightTally::SearchlightTally(const SearchlightScores& scores) {
  const std::size_t size = kPowers + scores.frequencies.size();
  for (Side& side : sides) {
    side.within.resize(scores.radii.size());
    side.within_squares.resize(scores.radii.size());
    side.moments.resize(size);
    side.products.resize(size * (size + 1) / 2);
  }
}

void SearchlightTally::add(const SearchlightTally& other) {
  for (std::size_t s = 0; s < sides.size(); ++s) {
    add_all(sides[s].within, other.sides[s].within);
    add_all(sides[s].within_squares, other.sides[s].within_squares);
    add_all(sides[s].moments, other.sides[s].moments);
    add_all(sides[s].products, other.sides[s].products);
  }
  count += other.count;
  events += other.events;
}

void SearchlightTally::add_sample(const SearchlightScores& scores, const Leaving& leaving) {
  ++count;
  for (std::size_t s = 0; s < sides.size(); ++s) {
    Side& side = sides[s];
    // At most two exits per side; sort them by distance.
    std::array<Leaving::Exit, 2> exits;
    std::size_t found = 0;
    for (const Leaving::Exit& exit : leaving) {
      if (exit.above == (s == 0)) {
        exits[found++] = exit;
      }
    }
    if (found == 0) {
      continue;
    }
    if (found == 2 && exits[1].r < exits[0].r) {
      std::swap(exits[0], exits[1]);
    }
    double inside = 0.0;
    for (std::size_t k = 0; k < found; ++k) {
      const auto radius = std::lower_bound(scores.radii.begin(), scores.radii.end(), exits[k].r);
      if (radius != scores.radii.end()) {
        const auto bin = static_cast<std::size_t>(radius - scores.radii.begin());
        side.within[bin] += exits[k].weight;
        side.within_squares[bin] += exits[k].weight * (2.0 * inside + exits[k].weight);
      }
      inside += exits[k].weight;
    }
    // The vector v of scores, and the products of its components.
    std::array<double, kPowers> powers = {};
    for (std::size_t k = 0; k < found; ++k) {
      const double r = exits[k].r;
      powers[0] += exits[k].weight;
      powers[1] += exits[k].weight * r;
      powers[2] += exits[k].weight * r * r;
    }
    thread_local std::vector<double> scored;
    scored.assign(powers.begin(), powers.end());
    for (const double q : scores.frequencies) {
      double sum = 0.0;
      for (std::size_t k = 0; k < found; ++k) {
        sum += exits[k].weight * bessel_j0(q * exits[k].r);
      }
      scored.push_back(sum);
    }
    std::size_t product = 0;
    for (std::size_t i = 0; i < scored.size(); ++i) {
      side.moments[i] += scored[i];
      for (std::size_t j = i; j < scored.size(); ++j) {
        side.products[product++] += scored[i] * scored[j];
      }
    }
  }
}

SearchlightTally run_lateral_walk(const LateralWalk& walk, const SearchlightScores& scores, std::uint64_t seed,
                                  std::uint64_t first_block, std::uint64_t last_block, ThreadPool& pool) {
  return sum_of_blocks(
      SearchlightTally(scores), seed, first_block, last_block, pool,
      [&](Rng& rng, SearchlightTally& tally) { tally.add_sample(scores, walk.sample(rng, tally.events)); });
}

}  // namespace lamina
