// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided_walk.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "ground_end.hpp"
#include "height_sampling.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Least probability of a term.
constexpr double kLeast = 0.02;
/// Least of what vertices of a graded medium are taken to add, against the most.
constexpr float kLeastSource = 1e-3F;
/// Azimuths of the candidates' lattice, to be turned by a random angle.
struct Lattice {
  std::array<double, GuidedWalk::kMostCandidates> cosine;
  std::array<double, GuidedWalk::kMostCandidates> sine;

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

/// A slab of thickness `top`, in cell `cell` of the guide, between two directions, still to be estimated.
struct GuidedWalk::Branch {
  double top;
  std::size_t cell;
  SlabRay a;
  SlabRay b;
};

/// Where light scatters.
struct GuidedWalk::Vertex {
  double t;
  std::size_t cell;
  double up;  ///< way up in the cell
  LocalScattering scattering;
};

GuidedWalk::GuidedWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, int candidates,
                       std::shared_ptr<const ScatteringGuide> guide)
    : medium_(medium),
      guide_(std::move(guide)),
      view_(SlabRay::of(mu_o, dphi)),
      light_(SlabRay::of(mu_i, 0.0)),
      candidates_(candidates) {
  if (candidates != 8 && candidates != 16 && candidates != 32) {
    throw std::invalid_argument("candidates: must be 8, 16 or 32");
  }
}

/// k S: a direction by k around `from` or from where the tables say S is large, among candidates of both sorts in
/// proportion to k S~ / mu'.
template <int kOwn, int kDrawn>
GuidedWalk::Step GuidedWalk::scatter(const Vertex& vertex, const SlabRay& from, const SlabRay& other, Rng& rng) const {
  constexpr int kAll = kOwn + kDrawn;
  using Values = Eigen::Array<float, kAll, 1>;
  const ScatteringGuide::Slice slice(*guide_, vertex.cell, vertex.up, vertex.t, other, vertex.scattering, rng.uniform(),
                                     rng.uniform());
  const SlabFrame frame(from);
  const double shift = rng.uniform();
  const double turn = 2.0 * pi * rng.uniform();
  const double turn_cosine = std::cos(turn);
  const double turn_sine = std::sin(turn);
  std::array<SlabRay, kAll> rays;
  for (std::size_t k = 0; k < kOwn; ++k) {
    const double c = vertex.scattering.sample((static_cast<double>(k) + shift) / static_cast<double>(kOwn));
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
  Values value = slice(x, y, mu);
  const double albedo = vertex.scattering.albedo();
  constexpr double kSphere = 1.0 / (4.0 * pi);
  Values drawn = Values::Zero();
  if constexpr (kDrawn > 0) {
    drawn = slice.density(x, y, mu);
    const Values k = vertex.scattering.evaluate_all(
        Values(static_cast<float>(from.x) * x + static_cast<float>(from.y) * y + static_cast<float>(from.mu) * mu));
    const Values own = static_cast<float>(kSphere / albedo) * k;
    value = value * own / (static_cast<float>(kOwn) * own + static_cast<float>(kDrawn) * drawn);
  } else {
    value *= 1.0F / static_cast<float>(kOwn);
  }
  const std::size_t chosen = choose(value, rng);
  if (chosen == kAll) {
    return {from, 0.0};
  }
  const SlabRay& ray = rays[chosen];
  const double own = kSphere * vertex.scattering.evaluate(passed_on(from, ray)) / albedo;
  const double density = kOwn * own + kDrawn * static_cast<double>(drawn[static_cast<Eigen::Index>(chosen)]);
  const double odds = static_cast<double>(value[static_cast<Eigen::Index>(chosen)] / value.sum());
  return {ray, albedo * own / (density * odds * ray.mu)};
}

/// S k S: directions of both sides together, from all pairs of candidates.
bool GuidedWalk::turn(const Vertex& vertex, SlabRay& a, SlabRay& b, double& weight, Rng& rng) const {
  constexpr int kSides = 8;
  using Values = Eigen::Array<float, kSides, 1>;
  std::array<std::array<SlabRay, kSides>, 2> rays;
  std::array<Values, 2> x;
  std::array<Values, 2> y;
  std::array<Values, 2> mu;
  std::array<Values, 2> density;
  std::array<Values, 2> share;
  const SlabRay* sides[2] = {&a, &b};
  for (std::size_t side = 0; side < 2; ++side) {
    const ScatteringGuide::Slice slice(*guide_, vertex.cell, vertex.up, vertex.t, *sides[side], vertex.scattering,
                                       rng.uniform(), rng.uniform());
    draw_from(slice, rays[side].data(), kSides, rng);
    for (std::size_t k = 0; k < kSides; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      x[side][i] = static_cast<float>(rays[side][k].x);
      y[side][i] = static_cast<float>(rays[side][k].y);
      mu[side][i] = static_cast<float>(rays[side][k].mu);
    }
    density[side] = slice.density(x[side], y[side], mu[side]);
    share[side] = slice(x[side], y[side], mu[side]) / density[side];
  }
  using Pairs = Eigen::Array<float, kSides * kSides, 1>;
  Pairs cosine;
  Pairs value;
  for (Eigen::Index i = 0; i < kSides; ++i) {
    cosine.segment<kSides>(i * kSides) = x[0][i] * x[1] + y[0][i] * y[1] - mu[0][i] * mu[1];
    value.segment<kSides>(i * kSides) = share[0][i] * share[1];
  }
  value *= vertex.scattering.evaluate_all(cosine);
  const std::size_t chosen = choose(value, rng);
  if (chosen == kSides * kSides) {
    return false;
  }
  const std::size_t i = chosen / kSides;
  const std::size_t j = chosen % kSides;
  const SlabRay& p = rays[0][i];
  const SlabRay& q = rays[1][j];
  const double odds = static_cast<double>(value[static_cast<Eigen::Index>(chosen)] / value.sum());
  const double both = static_cast<double>(density[0][static_cast<Eigen::Index>(i)]) *
                      static_cast<double>(density[1][static_cast<Eigen::Index>(j)]) * kSides * kSides;
  weight *= vertex.scattering.evaluate(turned_back(p, q)) / (16.0 * pi * pi * p.mu * q.mu * both * odds);
  a = p;
  b = q;
  return true;
}

GuidedWalk::Step GuidedWalk::step_from(const Vertex& vertex, const SlabRay& from, const SlabRay& other,
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

double GuidedWalk::sample(Rng& rng, std::uint64_t& events) const {
  const GuideHeights& heights = guide_->heights();
  std::vector<Branch> waiting;
  double weight = 1.0 / (4.0 * pi * view_.mu * light_.mu);
  Branch branch{medium_.tau(), heights.last_cell(), view_, light_};
  const bool homogeneous = medium_.is_homogeneous();
  while (true) {
    ++events;
    const SlabRay a = branch.a;
    const SlabRay b = branch.b;
    const double cosine = turned_back(a, b);
    const ScatteringGuide::Terms terms(*guide_, a, b);
    const double plain = homogeneous ? medium_.at(0.0).evaluate(cosine) : 0.0;
    const ScatteringGuide::Column repeated_column = terms.repeated();
    ScatteringGuide::Column source = repeated_column + static_cast<float>(plain);
    if (!homogeneous) {
      for (std::size_t j = 0; j <= branch.cell + 1; ++j) {
        source[static_cast<Eigen::Index>(j)] += static_cast<float>(medium_.at(heights[j]).evaluate(cosine));
      }
      // What lies between the guide's heights may scatter where they do not.
      source = source.max(kLeastSource * source.maxCoeff());
    }
    if (medium_.ground() > 0.0) {
      const GroundEnd ground(medium_.ground(), a.mu, b.mu, heights, branch.top, source);
      if (rng.uniform() < ground.odds) {
        weight *= ground.value / ground.odds;
        if (waiting.empty()) {
          return weight;
        }
        branch = waiting.back();
        waiting.pop_back();
        continue;
      }
      weight /= 1.0 - ground.odds;
    }
    const HeightSampling::Choice choice =
        HeightSampling::draw(heights, branch.top, branch.cell, 1.0 / a.mu + 1.0 / b.mu, source, rng);
    weight *= choice.weight;
    const Vertex vertex{choice.t, choice.cell, heights.fraction(choice.t, choice.cell), medium_.at(choice.t)};

    if (vertex.scattering.albedo() == 0.0) {
      return 0.0;
    }

    // One term, in proportion to the tables.
    const double k = homogeneous ? plain : vertex.scattering.evaluate(cosine);
    const auto low = static_cast<double>(repeated_column[static_cast<Eigen::Index>(vertex.cell)]);
    const auto high = static_cast<double>(repeated_column[static_cast<Eigen::Index>(vertex.cell + 1)]);
    const double repeated = low + vertex.up * (high - low);
    const double one_a = terms.one_side(vertex.cell, vertex.up, true);
    const double one_b = terms.one_side(vertex.cell, vertex.up, false);
    const double both = std::max(0.0, repeated - one_a - one_b);
    const double least = kLeast * (k + one_a + one_b + both);
    const double weights[4] = {std::max(k, least), std::max(one_a, least), std::max(one_b, least),
                               std::max(both, least)};
    const double all = weights[0] + weights[1] + weights[2] + weights[3];
    const double u = rng.uniform();
    bool ended = false;
    const double odds[3] = {weights[0] / all, weights[1] / all, weights[2] / all};
    if (u < odds[0]) {
      weight *= k / odds[0];
      ended = true;
    } else if (u < odds[0] + odds[1] + odds[2]) {
      const bool first = u < odds[0] + odds[1];
      const Step step = step_from(vertex, first ? a : b, first ? b : a, rng);
      weight *= step.weight / (first ? odds[1] : odds[2]);
      branch = {vertex.t, vertex.cell, step.ray, first ? b : a};
    } else {
      SlabRay p = a;
      SlabRay q = b;
      weight *= all / weights[3];
      if (!turn(vertex, p, q, weight, rng)) {
        return 0.0;
      }
      branch = {vertex.t, vertex.cell, p, a};
      waiting.push_back({vertex.t, vertex.cell, q, b});
    }
    if (weight == 0.0) {
      return 0.0;
    }
    if (ended) {
      if (waiting.empty()) {
        return weight;
      }
      branch = waiting.back();
      waiting.pop_back();
    }
  }
}

}  // namespace lamina
