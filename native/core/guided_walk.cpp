// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided_walk.hpp"

#include <array>
#include <numbers>
#include <stdexcept>

#include "height_sampling.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Least probability of a term.
constexpr double kLeast = 0.01;
/// Directions on each side of a vertex that turns light back: all their pairs are weighed.
constexpr std::size_t kSides = 8;

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
const Lattice kLattice;

}  // namespace

/// A slab of thickness `top`, in cell `cell` of the guide, between two directions, still to be estimated.
struct GuidedWalk::Branch {
  double top;
  std::size_t cell;
  Ray a;
  Ray b;
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
      view_{std::sqrt(1.0 - mu_o * mu_o) * std::cos(dphi), std::sqrt(1.0 - mu_o * mu_o) * std::sin(dphi), mu_o},
      light_{std::sqrt(1.0 - mu_i * mu_i), 0.0, mu_i},
      candidates_(static_cast<std::size_t>(candidates)) {
  if (candidates < 1 || candidates > kMostCandidates) {
    throw std::invalid_argument("candidates: must lie in [1, 32]");
  }
}

/// k S: a direction around `from`, by k exactly, among candidates by what S~ brings from there.
GuidedWalk::Step GuidedWalk::scatter(const Vertex& vertex, const Ray& from, const Ray& other, Rng& rng) const {
  const ScatteringGuide::Slice slice(*guide_, vertex.cell, vertex.up, vertex.t, other, vertex.scattering);
  const double sine = std::sqrt(from.x * from.x + from.y * from.y);
  const double cx = sine > 0.0 ? from.x / sine : 1.0;
  const double cy = sine > 0.0 ? from.y / sine : 0.0;
  const double shift = rng.uniform();
  const double turn = 2.0 * pi * rng.uniform();
  const double turn_cosine = std::cos(turn);
  const double turn_sine = std::sin(turn);
  std::array<Ray, kMostCandidates> rays;
  std::array<double, kMostCandidates> value;
  double total = 0.0;
  for (std::size_t k = 0; k < candidates_; ++k) {
    const double c = vertex.scattering.sample((static_cast<double>(k) + shift) / static_cast<double>(candidates_));
    const double s = std::sqrt(std::max(0.0, 1.0 - c * c));
    const double along = s * (turn_cosine * kLattice.cosine[k] - turn_sine * kLattice.sine[k]);
    const double aside = s * (turn_sine * kLattice.cosine[k] + turn_cosine * kLattice.sine[k]);
    const double outward = c * sine + along * from.mu;
    rays[k] = {outward * cx - aside * cy, outward * cy + aside * cx, c * from.mu - along * sine};
    value[k] = rays[k].mu > 0.0 ? slice(rays[k]) : 0.0;
    total += value[k];
  }
  if (!(total > 0.0)) {
    return {from, 0.0};
  }
  double rest = rng.uniform() * total;
  std::size_t chosen = 0;
  for (; chosen + 1 < candidates_ && rest >= value[chosen]; ++chosen) {
    rest -= value[chosen];
  }
  if (!(value[chosen] > 0.0)) {
    return {from, 0.0};
  }
  const Ray& ray = rays[chosen];
  return {ray, vertex.scattering.albedo() * total / (static_cast<double>(candidates_) * value[chosen] * ray.mu)};
}

/// S k S: directions of both sides together.
bool GuidedWalk::turn(const Vertex& vertex, Ray& a, Ray& b, double& weight, Rng& rng) const {
  std::array<std::array<Ray, kSides>, 2> rays;
  std::array<std::array<double, kSides>, 2> share;
  std::array<std::array<double, kSides>, 2> density;
  const Ray* sides[2] = {&a, &b};
  for (std::size_t side = 0; side < 2; ++side) {
    const Ray& own = *sides[side];
    const ScatteringGuide::Slice slice(*guide_, vertex.cell, vertex.up, vertex.t, own, vertex.scattering);
    const ScatteringGuide::Place place = ScatteringGuide::Place::of_cosine(own.mu);
    const std::size_t height = vertex.cell + (rng.uniform() < vertex.up ? 1 : 0);
    const std::size_t point = place.cell + (rng.uniform() < static_cast<double>(place.fraction) ? 1 : 0);
    const double shift = rng.uniform();
    for (std::size_t k = 0; k < kSides; ++k) {
      const double u = (static_cast<double>(k) + shift) / static_cast<double>(kSides);
      const ScatteringGuide::Drawn drawn =
          guide_->draw(height, point, own, u, rng.uniform(), rng.uniform());
      rays[side][k] = drawn.ray;
      density[side][k] = drawn.density;
      share[side][k] = slice(drawn.ray) / drawn.density;
    }
  }
  std::array<double, kSides * kSides> value;
  double total = 0.0;
  for (std::size_t i = 0; i < kSides; ++i) {
    for (std::size_t j = 0; j < kSides; ++j) {
      const Ray& p = rays[0][i];
      const Ray& q = rays[1][j];
      const double k = vertex.scattering.evaluate(p.x * q.x + p.y * q.y - p.mu * q.mu);
      total += value[i * kSides + j] = k * share[0][i] * share[1][j];
    }
  }
  if (!(total > 0.0)) {
    return false;
  }
  double rest = rng.uniform() * total;
  std::size_t chosen = 0;
  for (; chosen + 1 < value.size() && rest >= value[chosen]; ++chosen) {
    rest -= value[chosen];
  }
  const std::size_t i = chosen / kSides;
  const std::size_t j = chosen % kSides;
  const Ray& p = rays[0][i];
  const Ray& q = rays[1][j];
  const double k = vertex.scattering.evaluate(p.x * q.x + p.y * q.y - p.mu * q.mu);
  const double mean = total / static_cast<double>(value.size());
  weight *= mean * k /
            (value[chosen] * 16.0 * pi * pi * p.mu * q.mu * density[0][i] * density[1][j]);
  a = p;
  b = q;
  return true;
}

double GuidedWalk::sample(Rng& rng, std::uint64_t& events) const {
  const GuideHeights& heights = guide_->heights();
  std::vector<Branch> waiting;
  double weight = 1.0 / (4.0 * pi * view_.mu * light_.mu);
  Branch branch{medium_.tau(), heights.last_cell(), view_, light_};
  const bool homogeneous = medium_.is_homogeneous();
  while (true) {
    ++events;
    const Ray a = branch.a;
    const Ray b = branch.b;
    const double cosine = a.x * b.x + a.y * b.y - a.mu * b.mu;
    const ScatteringGuide::Terms terms(*guide_, a, b);
    const double plain = homogeneous ? medium_.at(0.0).evaluate(cosine) : 0.0;
    const auto once = [&](std::size_t j) {
      return homogeneous ? plain : medium_.at(heights[j]).evaluate(cosine);
    };
    const HeightSampling::Choice choice =
        HeightSampling::draw(heights, branch.top, branch.cell, 1.0 / a.mu + 1.0 / b.mu,
                             [&](std::size_t j) { return once(j) + terms.repeated(j); }, rng);
    weight *= choice.integral / choice.source;
    const Vertex vertex{choice.t, choice.cell, heights.fraction(choice.t, choice.cell), medium_.at(choice.t)};

    // One term, in proportion to the tables.
    const auto between = [&](double low, double high) { return low + vertex.up * (high - low); };
    const double k = homogeneous ? plain : vertex.scattering.evaluate(cosine);
    const double repeated = between(terms.repeated(vertex.cell), terms.repeated(vertex.cell + 1));
    const double one_a = between(terms.one_side(vertex.cell, true), terms.one_side(vertex.cell + 1, true));
    const double one_b = between(terms.one_side(vertex.cell, false), terms.one_side(vertex.cell + 1, false));
    const double both = std::max(0.0, repeated - one_a - one_b);
    const double all = k + one_a + one_b + both;
    const auto probability = [&](double term) { return kLeast + (1.0 - 4.0 * kLeast) * term / all; };
    double u = rng.uniform();
    bool ended = false;
    const double odds[3] = {probability(k), probability(one_a), probability(one_b)};
    if (u < odds[0]) {
      weight *= k / odds[0];
      ended = true;
    } else if (u < odds[0] + odds[1] + odds[2]) {
      const bool first = u < odds[0] + odds[1];
      const Step step = scatter(vertex, first ? a : b, first ? b : a, rng);
      weight *= step.weight / (first ? odds[1] : odds[2]);
      branch = {vertex.t, vertex.cell, step.ray, first ? b : a};
    } else {
      Ray p = a;
      Ray q = b;
      weight /= probability(both);
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
