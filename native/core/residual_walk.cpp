// SPDX-License-Identifier: GPL-3.0-or-later
#include "residual_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "height_sampling.hpp"
#include "single_scattering.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Least probability of a term.
constexpr double kLeast = 0.02;
constexpr double kFloor = 1e-3;
/// Least share of S that R counts for where it is decided whether to go on.
constexpr double kLeastRest = 0.05;
/// Probability of going on with a branch that is worth all that is to be found, and with one that is worth nothing.
constexpr double kEager = 0.6;
constexpr double kLeastOn = 0.05;

/// Azimuths of the candidates' lattice, to be turned by a random angle.
struct Lattice {
  std::array<double, ResidualWalk::kMostCandidates> cosine;
  std::array<double, ResidualWalk::kMostCandidates> sine;

  Lattice() {
    for (std::size_t k = 0; k < cosine.size(); ++k) {
      const double turn = 2.0 * pi * static_cast<double>(k) / std::numbers::phi;
      cosine[k] = std::cos(turn);
      sine[k] = std::sin(turn);
    }
  }
};
const Lattice lattice;

/// One of several in proportion to their values; their number where none has any.
template <typename Values>
std::size_t choose(const Values& value, Rng& rng) {
  const float total = value.sum();
  if (!(total > 0.0F)) {
    return static_cast<std::size_t>(value.size());
  }
  auto rest = static_cast<float>(rng.uniform()) * total;
  Eigen::Index last = 0;
  for (Eigen::Index k = 0; k < value.size(); ++k) {
    if (value[k] > 0.0F) {
      last = k;
      if (rest < value[k]) {
        break;
      }
      rest -= value[k];
    }
  }
  return static_cast<std::size_t>(last);
}

/// Several directions from where the tables say S is large, on a shifted lattice.
void draw_from(const ScatteringGuide::Slice& slice, SlabRay* rays, std::size_t count, Rng& rng) {
  // Additive recurrences of the plastic number's kind (Roberts 2018).
  constexpr double kFirst = 0.7548776662466927;
  constexpr double kSecond = 0.5698402909980532;
  const double shift = rng.uniform();
  double v = rng.uniform();
  double w = rng.uniform();
  for (std::size_t k = 0; k < count; ++k) {
    rays[k] = slice.draw((static_cast<double>(k) + shift) / static_cast<double>(count), v, w);
    v += v + kFirst < 1.0 ? kFirst : kFirst - 1.0;
    w += w + kSecond < 1.0 ? kSecond : kSecond - 1.0;
  }
}

}  // namespace

/// S of a slab between two directions, still to be estimated.
struct ResidualWalk::Branch {
  double top;
  std::size_t cell;  ///< of the guide's heights
  SlabRay a;
  SlabRay b;
  double once;  ///< S1
  double rest;  ///< R~
};

/// Where light scatters.
struct ResidualWalk::Vertex {
  double t;
  std::size_t cell;
  double up;  ///< way up in the cell
};

struct ResidualWalk::Step {
  SlabRay ray;
  double weight;  ///< 0: nothing comes
  double value;   ///< S~ there
};

/// Directions of both sides.
struct ResidualWalk::Pair {
  SlabRay p;
  SlabRay q;
  double weight = 0.0;  ///< 0: nothing comes
  double value_p = 0.0;
  double value_q = 0.0;
};

ResidualWalk::ResidualWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
                           std::shared_ptr<const ScatteringGuide> guide)
    : medium_(medium),
      guide_(std::move(guide)),
      view_(SlabRay::of(mu_o, dphi)),
      light_(SlabRay::of(mu_i, 0.0)),
      candidates_(candidates),
      scattering_(medium_.at(0.0)),
      root_(medium_, *guide_, view_, light_),
      once_(scattering_.evaluate(turned_back(view_, light_)) * single_reflection(mu_o, mu_i, medium_.tau()) /
            (4.0 * pi)),
      scale_(1.0 / (4.0 * pi * mu_o * mu_i)) {
  if (candidates != 8 && candidates != 16 && candidates != 32) {
    throw std::invalid_argument("candidates: must be 8, 16 or 32");
  }
  if (!medium.is_homogeneous() || medium.ground() > 0.0) {
    throw std::invalid_argument("medium: must be homogeneous, over nothing");
  }
  // Of the order of kS at its least: linear where thin, and not zero where the tables may be by rounding.
  const ScatteringGuide::Column& t = guide_->heights().column();
  floor_ = static_cast<float>(kFloor * scattering_.albedo() * scattering_.albedo()) * t / (1.0F + t);
}

ResidualWalk::Branch ResidualWalk::branch(const Vertex& vertex, const SlabRay& a, const SlabRay& b,
                                          double value) const {
  const double once = scattering_.evaluate(turned_back(a, b)) * a.mu * b.mu * single_reflection(a.mu, b.mu, vertex.t);
  return {vertex.t, vertex.cell, a, b, once, std::max(0.0, value - once)};
}

template <int kOwn, int kDrawn>
ResidualWalk::Step ResidualWalk::scatter(const Vertex& vertex, const SlabRay& from, const SlabRay& other,
                                         Rng& rng) const {
  constexpr int kAll = kOwn + kDrawn;
  using Values = Eigen::Array<float, kAll, 1>;
  const ScatteringGuide::Slice slice(*guide_, vertex.cell, vertex.up, vertex.t, other, scattering_, rng.uniform(),
                                     rng.uniform());
  const SlabFrame frame(from);
  const double shift = rng.uniform();
  const double turn = 2.0 * pi * rng.uniform();
  const double turn_cosine = std::cos(turn);
  const double turn_sine = std::sin(turn);
  std::array<SlabRay, kAll> rays;
  for (std::size_t k = 0; k < kOwn; ++k) {
    const double c = scattering_.sample((static_cast<double>(k) + shift) / static_cast<double>(kOwn));
    const double s = std::sqrt(std::max(0.0, 1.0 - c * c));
    const double along = s * (turn_cosine * lattice.cosine[k] - turn_sine * lattice.sine[k]);
    const double aside = s * (turn_sine * lattice.cosine[k] + turn_cosine * lattice.sine[k]);
    rays[k] = frame.tilted(c, along, aside);
  }
  draw_from(slice, &rays[kOwn], kDrawn, rng);
  Values x;
  Values y;
  Values mu;
  for (std::size_t k = 0; k < kAll; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    x[i] = static_cast<float>(rays[k].x);
    y[i] = static_cast<float>(rays[k].y);
    mu[i] = static_cast<float>(rays[k].mu);
  }
  const Values light = slice(x, y, mu);
  Values value = light;
  const double albedo = scattering_.albedo();
  constexpr double kSphere = 1.0 / (4.0 * pi);
  Values drawn = Values::Zero();
  if constexpr (kDrawn > 0) {
    drawn = slice.density(x, y, mu);
    const Values k = scattering_.evaluate_all(
        Values(static_cast<float>(from.x) * x + static_cast<float>(from.y) * y + static_cast<float>(from.mu) * mu));
    const Values own = static_cast<float>(kSphere / albedo) * k;
    value = value * own / (static_cast<float>(kOwn) * own + static_cast<float>(kDrawn) * drawn);
  } else {
    value *= 1.0F / static_cast<float>(kOwn);
  }
  const std::size_t chosen = choose(value, rng);
  if (chosen == kAll) {
    return {from, 0.0, 0.0};
  }
  const SlabRay& ray = rays[chosen];
  const double own = kSphere * scattering_.evaluate(passed_on(from, ray)) / albedo;
  const double density = kOwn * own + kDrawn * static_cast<double>(drawn[static_cast<Eigen::Index>(chosen)]);
  const double odds = static_cast<double>(value[static_cast<Eigen::Index>(chosen)] / value.sum());
  return {ray, albedo * own / (density * odds * ray.mu),
          static_cast<double>(light[static_cast<Eigen::Index>(chosen)]) * ray.mu};
}

/// S k S: directions of both sides together, from all pairs of candidates.
ResidualWalk::Pair ResidualWalk::turn(const Vertex& vertex, const SlabRay& a, const SlabRay& b, Rng& rng) const {
  constexpr int kSides = 8;
  using Values = Eigen::Array<float, kSides, 1>;
  std::array<std::array<SlabRay, kSides>, 2> rays;
  std::array<Values, 2> x;
  std::array<Values, 2> y;
  std::array<Values, 2> mu;
  std::array<Values, 2> density;
  std::array<Values, 2> light;
  std::array<Values, 2> share;
  const SlabRay* sides[2] = {&a, &b};
  for (std::size_t side = 0; side < 2; ++side) {
    const ScatteringGuide::Slice slice(*guide_, vertex.cell, vertex.up, vertex.t, *sides[side], scattering_,
                                       rng.uniform(), rng.uniform());
    draw_from(slice, rays[side].data(), kSides, rng);
    for (std::size_t k = 0; k < kSides; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      x[side][i] = static_cast<float>(rays[side][k].x);
      y[side][i] = static_cast<float>(rays[side][k].y);
      mu[side][i] = static_cast<float>(rays[side][k].mu);
    }
    density[side] = slice.density(x[side], y[side], mu[side]);
    light[side] = slice(x[side], y[side], mu[side]);
    share[side] = light[side] / density[side];
  }
  using Pairs = Eigen::Array<float, kSides * kSides, 1>;
  Pairs cosine;
  Pairs value;
  for (Eigen::Index i = 0; i < kSides; ++i) {
    cosine.segment<kSides>(i * kSides) = x[0][i] * x[1] + y[0][i] * y[1] - mu[0][i] * mu[1];
    value.segment<kSides>(i * kSides) = share[0][i] * share[1];
  }
  value *= scattering_.evaluate_all(cosine);
  const std::size_t chosen = choose(value, rng);
  if (chosen == kSides * kSides) {
    return {};
  }
  const std::size_t i = chosen / kSides;
  const std::size_t j = chosen % kSides;
  const SlabRay& p = rays[0][i];
  const SlabRay& q = rays[1][j];
  const double odds = static_cast<double>(value[static_cast<Eigen::Index>(chosen)] / value.sum());
  const double both = static_cast<double>(density[0][static_cast<Eigen::Index>(i)]) *
                      static_cast<double>(density[1][static_cast<Eigen::Index>(j)]) * kSides * kSides;
  const double weight = scattering_.evaluate(turned_back(p, q)) / (16.0 * pi * pi * p.mu * q.mu * both * odds);
  return {p, q, weight, static_cast<double>(light[0][static_cast<Eigen::Index>(i)]) * p.mu,
          static_cast<double>(light[1][static_cast<Eigen::Index>(j)]) * q.mu};
}

ResidualWalk::Step ResidualWalk::step_from(const Vertex& vertex, const SlabRay& from, const SlabRay& other,
                                           Rng& rng) const {
  switch (candidates_) {
    case 8:
      return scatter<4, 4>(vertex, from, other, rng);
    case 16:
      return scatter<12, 4>(vertex, from, other, rng);
    default:
      return scatter<24, 8>(vertex, from, other, rng);
  }
}

/// S of the branch. `worth` times a value of S is what that adds to the sample, relative to R~ of the whole.
double ResidualWalk::estimate(Branch branch, double worth, Rng& rng, std::uint64_t& events) const {
  const GuideHeights& heights = guide_->heights();
  double sum = 0.0;
  double weight = 1.0;
  while (true) {
    const double all = branch.once + branch.rest;
    const double q = std::clamp(kEager * worth * std::max(branch.rest, kLeastRest * all), kLeastOn, 1.0);
    if (rng.uniform() >= q) {
      return sum + weight * all;
    }
    sum += weight * (all - branch.rest / q);
    weight /= q;
    worth /= q;
    ++events;
    const SlabRay a = branch.a;
    const SlabRay b = branch.b;
    const ScatteringGuide::Terms terms(*guide_, a, b);
    const ScatteringGuide::Column source = terms.repeated() + floor_;
    const HeightSampling::Choice choice =
        HeightSampling::draw(heights, branch.top, branch.cell, 1.0 / a.mu + 1.0 / b.mu, source, rng);
    const Vertex vertex{choice.t, choice.cell, heights.fraction(choice.t, choice.cell)};

    // One term, in proportion to the tables.
    const auto low = static_cast<double>(source[static_cast<Eigen::Index>(vertex.cell)]);
    const auto high = static_cast<double>(source[static_cast<Eigen::Index>(vertex.cell + 1)]);
    const double repeated = low + vertex.up * (high - low);
    const double one_a = terms.one_side(vertex.cell, vertex.up, true);
    const double one_b = terms.one_side(vertex.cell, vertex.up, false);
    const double least = kLeast * repeated;
    const double weights[3] = {std::max(one_a, least), std::max(one_b, least),
                               std::max(repeated - one_a - one_b, least)};
    const double total = weights[0] + weights[1] + weights[2];
    const double u = rng.uniform() * total;
    double factor = choice.weight * total;
    if (u < weights[0] + weights[1]) {
      const bool first = u < weights[0];
      const Step step = step_from(vertex, first ? a : b, first ? b : a, rng);
      factor *= step.weight / weights[first ? 0 : 1];
      if (!(factor > 0.0)) {
        return sum;
      }
      branch = this->branch(vertex, step.ray, first ? b : a, step.value);
    } else {
      const Pair pair = turn(vertex, a, b, rng);
      factor *= pair.weight / weights[2];
      if (!(factor > 0.0)) {
        return sum;
      }
      const double side =
          estimate(this->branch(vertex, pair.p, a, pair.value_p), worth * factor * pair.value_q, rng, events);
      branch = this->branch(vertex, pair.q, b, pair.value_q);
      factor *= side;
    }
    weight *= factor;
    worth *= std::abs(factor);
  }
}

double ResidualWalk::sample(Rng& rng, std::uint64_t& events) const {
  ++events;
  const RootVertex::Choice choice = root_.draw(rng);
  if (choice.weight == 0.0) {
    return once_;
  }
  const Vertex vertex{choice.t, choice.cell, choice.up};
  const double worth = choice.weight / root_.rest();
  double rest = choice.weight;
  if (choice.term == RootVertex::Term::kBoth) {
    const Pair pair = turn(vertex, view_, light_, rng);
    if (!(pair.weight > 0.0)) {
      return once_;
    }
    const double factor = pair.weight * worth;
    const double side = estimate(branch(vertex, pair.p, view_, pair.value_p), factor * pair.value_q, rng, events);
    rest *= pair.weight * side *
            estimate(branch(vertex, pair.q, light_, pair.value_q), factor * std::abs(side), rng, events);
  } else {
    const SlabRay& other = choice.term == RootVertex::Term::kOfA ? light_ : view_;
    const double value = guide_->value(vertex.cell, vertex.up, vertex.t, choice.ray, other, scattering_);
    rest *= estimate(branch(vertex, choice.ray, other, value), worth, rng, events);
  }
  return once_ + scale_ * rest;
}

}  // namespace lamina
