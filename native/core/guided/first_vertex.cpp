// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/first_vertex.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "guided/height_sampling.hpp"

namespace lamina {
namespace {

// Floors, which bound the weights where the tables are too small. The estimate is unbiased for any of them.

/// Least value of a square, relative to the mean.
constexpr double kLeastSquare = 0.02;
/// Least value of a square, relative to its largest neighbour: sample points may miss a part that is above the horizon.
constexpr float kLeastOfNeighbours = 0.2F;
/// Least share of SkS, relative to kS + Sk.
constexpr double kLeastTerm = 0.01;

/// Alias table of Walker's method in Vose's form (1991); the values must not all be 0.
void make_alias(const float* value, std::size_t count, float* keep, std::uint16_t* alias) {
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    sum += static_cast<double>(value[k]);
  }
  std::vector<double> share(count);
  std::vector<std::uint16_t> small;
  std::vector<std::uint16_t> large;
  for (std::size_t k = 0; k < count; ++k) {
    share[k] = static_cast<double>(value[k]) * static_cast<double>(count) / sum;
    (share[k] < 1.0 ? small : large).push_back(static_cast<std::uint16_t>(k));
    keep[k] = 1.0F;
    alias[k] = static_cast<std::uint16_t>(k);
  }
  while (!small.empty() && !large.empty()) {
    const std::uint16_t low = small.back();
    const std::uint16_t high = large.back();
    small.pop_back();
    keep[low] = static_cast<float>(share[low]);
    alias[low] = high;
    share[high] -= 1.0 - share[low];
    if (share[high] < 1.0) {
      large.pop_back();
      small.push_back(high);
    }
  }
}

}  // namespace

FirstVertex::FirstVertex(const GradedMedium& medium, const ScatteringGuide& guide, const SlabRay& a, const SlabRay& b)
    : heights_(guide.heights()), scattering_(medium.at(0.0)), slope_(1.0 / a.mu + 1.0 / b.mu) {
  divide();
  sides_[0].from = a;
  sides_[1].from = b;
  tabulate(sides_[0], guide, b);
  tabulate(sides_[1], guide, a);
  const ScatteringGuide::Terms terms(guide, a, b);
  const ScatteringGuide::Column repeated = terms.repeated();
  const std::size_t last = heights_.last_cell();
  for (std::size_t j = 0; j < heights_.size(); ++j) {
    const std::size_t cell = std::min(j, last);
    const double up = j > last ? 1.0 : 0.0;
    const auto row = static_cast<Eigen::Index>(j);
    const double both =
        static_cast<double>(repeated[row]) - terms.one_side(cell, up, true) - terms.one_side(cell, up, false);
    const float sides = sides_[0].mean[row] + sides_[1].mean[row];
    both_[row] = std::max(static_cast<float>(both), static_cast<float>(kLeastTerm) * sides);
    source_[row] = sides + both_[row];
  }
  const double top = heights_[heights_.size() - 1];
  mass_.setZero();
  for (std::size_t j = 0; j <= last; ++j) {
    const double thickness = heights_[j + 1] - heights_[j];
    const double depth = slope_ * thickness;
    const EndShares shares(depth, std::exp(-depth));
    const auto row = static_cast<Eigen::Index>(j);
    const double mass =
        std::exp(-slope_ * (top - heights_[j + 1])) * thickness *
        (shares.lower * static_cast<double>(source_[row]) + shares.upper * static_cast<double>(source_[row + 1]));
    mass_[row] = static_cast<float>(mass);
    total_ += static_cast<double>(mass_[row]);
  }
}

/// Chooses the rows: half of them with equal probability, then the row widest in angle is halved until there are
/// enough.
void FirstVertex::divide() {
  constexpr std::size_t kEqual = kRows / 2;
  const auto angle = [&](double u) { return std::acos(std::clamp(scattering_.sample(u), -1.0, 1.0)); };
  std::vector<double> row;
  std::vector<double> at;
  for (std::size_t k = 0; k <= kEqual; ++k) {
    row.push_back(static_cast<double>(k) / static_cast<double>(kEqual));
    at.push_back(k == 0 ? std::numbers::pi : k == kEqual ? 0.0 : angle(row.back()));
  }
  while (row.size() < rows_.size()) {
    std::size_t widest = 0;
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
      if (at[k] - at[k + 1] > at[widest] - at[widest + 1]) {
        widest = k;
      }
    }
    const double wanted = 0.5 * (at[widest] + at[widest + 1]);
    double low = row[widest];
    double high = row[widest + 1];
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (low + high);
      (angle(middle) > wanted ? low : high) = middle;
    }
    const auto after = static_cast<std::ptrdiff_t>(widest) + 1;
    row.insert(row.begin() + after, 0.5 * (low + high));
    at.insert(at.begin() + after, wanted);
  }
  std::copy(row.begin(), row.end(), rows_.begin());
}

void FirstVertex::tabulate(Side& side, const ScatteringGuide& guide, const SlabRay& other) {
  // Compute the directions of several points of each square
  constexpr int kPoints = 2;
  constexpr int kEach = kPoints * kPoints;
  using Values = Eigen::Array<float, static_cast<int>(kTurns) * kEach, 1>;
  const std::size_t heights = heights_.size();
  side.value.resize(heights * kSquares);
  side.keep.resize(heights * kSquares);
  side.alias.resize(heights * kSquares);
  std::vector<Values> x(kRows);
  std::vector<Values> y(kRows);
  std::vector<Values> mu(kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t turn = 0; turn < kTurns; ++turn) {
      for (int k = 0; k < kEach; ++k) {
        const double part = (k / kPoints + 0.5) / kPoints;
        const SlabRay ray =
            direction(side, rows_[row] + part * (rows_[row + 1] - rows_[row]),
                      (static_cast<double>(turn) + (k % kPoints + 0.5) / kPoints) / static_cast<double>(kTurns));
        const auto i = static_cast<Eigen::Index>(turn) * kEach + k;
        x[row][i] = static_cast<float>(ray.x);
        y[row][i] = static_cast<float>(ray.y);
        mu[row][i] = static_cast<float>(ray.mu);
      }
    }
  }
  side.mean.setZero();
  for (std::size_t j = 1; j < heights; ++j) {
    const std::size_t cell = std::min(j, heights_.last_cell());
    const ScatteringGuide::Section section(guide, cell, j > cell ? 1.0 : 0.0, heights_[j], other, scattering_, 0.5,
                                           0.5);

    // Average S~ / mu' over the points of each square
    float* value = &side.value[j * kSquares];
    for (std::size_t row = 0; row < kRows; ++row) {
      const Values all = section(x[row], y[row], mu[row]);
      for (std::size_t turn = 0; turn < kTurns; ++turn) {
        value[row * kTurns + turn] = all.template segment<kEach>(static_cast<Eigen::Index>(turn) * kEach).mean();
      }
    }

    // Raise each square to a share of its largest neighbour
    const std::vector<float> alone(value, value + kSquares);
    for (std::size_t k = 0; k < kSquares; ++k) {
      const std::size_t row = k / kTurns;
      const std::size_t turn = k % kTurns;
      for (std::size_t other_row = row - std::min<std::size_t>(row, 1); other_row < std::min(row + 2, kRows);
           ++other_row) {
        for (const std::size_t other_turn : {(turn + kTurns - 1) % kTurns, turn, (turn + 1) % kTurns}) {
          value[k] = std::max(value[k], kLeastOfNeighbours * alone[other_row * kTurns + other_turn]);
        }
      }
    }

    // Raise squares to a share of the mean, and make the alias table of their masses
    std::vector<float> mass(kSquares);
    const auto measure = [&] {
      double sum = 0.0;
      for (std::size_t k = 0; k < kSquares; ++k) {
        const std::size_t row = k / kTurns;
        mass[k] = value[k] * static_cast<float>((rows_[row + 1] - rows_[row]) / static_cast<double>(kTurns));
        sum += static_cast<double>(mass[k]);
      }
      return sum;
    };
    const auto least = static_cast<float>(kLeastSquare * measure());
    for (std::size_t k = 0; k < kSquares; ++k) {
      value[k] = std::max(value[k], least);
    }
    const double mean = measure();
    if (mean > 0.0) {
      side.mean[static_cast<Eigen::Index>(j)] = static_cast<float>(scattering_.albedo() * mean);
      make_alias(mass.data(), kSquares, &side.keep[j * kSquares], &side.alias[j * kSquares]);
    }
  }
}

SlabRay FirstVertex::direction(const Side& side, double row, double turn) const {
  return SlabFrame(side.from).turned(scattering_.sample(row), 2.0 * std::numbers::pi * turn);
}

FirstVertex::Choice FirstVertex::draw(Rng& rng) const {
  Choice choice{Term::kNone, 0.0, 0, 0.0, 0.0, {}};
  if (!(total_ > 0.0)) {
    return choice;
  }

  // Draw the height: a cell by its mass, then a height within
  double rest = rng.uniform() * total_;
  auto own = static_cast<Eigen::Index>(heights_.last_cell());
  while (own > 0 && rest >= static_cast<double>(mass_[own])) {
    rest -= static_cast<double>(mass_[own]);
    --own;
  }
  if (!(mass_[own] > 0.0F)) {
    mass_.maxCoeff(&own);
  }
  choice.cell = static_cast<std::size_t>(own);
  const double top = heights_[heights_.size() - 1];
  const double high = heights_[choice.cell + 1];
  const HeightSampling::Point point =
      HeightSampling::within(heights_[choice.cell], high, slope_, static_cast<double>(source_[own]),
                             static_cast<double>(source_[own + 1]), rng);
  choice.t = point.t;
  choice.up = heights_.fraction(point.t, choice.cell);

  // Draw the term by its share of the source g
  const double height = std::exp(-slope_ * (top - high)) * point.weight * total_ / static_cast<double>(mass_[own]);
  const auto between = [&](const ScatteringGuide::Column& column) {
    const auto low = static_cast<double>(column[own]);
    return low + choice.up * (static_cast<double>(column[own + 1]) - low);
  };
  const double g = between(source_);
  const double one_a = between(sides_[0].mean);
  const double one_b = between(sides_[1].mean);
  double u = rng.uniform() * g;
  if (u >= one_a + one_b) {
    choice.term = Term::kBoth;
    choice.weight = height * g / between(both_);
    return choice;
  }
  const bool first = u < one_a;
  choice.term = first ? Term::kOfA : Term::kOfB;
  u = first ? u / one_a : (u - one_a) / one_b;
  const Side& side = sides_[first ? 0 : 1];

  // Draw one of the two neighbouring tables, then a square by its alias table, and a point in the square
  const double upper = choice.up * static_cast<double>(side.mean[own + 1]) / (first ? one_a : one_b);
  const std::size_t j = choice.cell + (u < upper ? 1 : 0);
  const double place = rng.uniform() * static_cast<double>(kSquares);
  auto square = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(square);
  double turn = rng.uniform();
  double row = 0.0;
  const auto keep = static_cast<double>(side.keep[j * kSquares + square]);
  if (part < keep) {
    row = part / keep;
  } else {
    square = side.alias[j * kSquares + square];
    row = (part - keep) / (1.0 - keep);
  }

  // Divide by the density, which interpolates both tables
  const double low = static_cast<double>(side.value[choice.cell * kSquares + square]);
  const double value = low + choice.up * (static_cast<double>(side.value[(choice.cell + 1) * kSquares + square]) - low);
  const std::size_t first_row = square / kTurns;
  row = rows_[first_row] + row * (rows_[first_row + 1] - rows_[first_row]);
  turn = (static_cast<double>(square % kTurns) + turn) / static_cast<double>(kTurns);
  choice.ray = direction(side, row, turn);
  choice.weight = choice.ray.mu > 0.0 ? height * g / (value * choice.ray.mu) : 0.0;
  return choice;
}

}  // namespace lamina
