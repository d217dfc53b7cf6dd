// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/guided_directions.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "numeric/azimuth_lattice.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

const AzimuthLattice<GuidedDirections::kMostCandidates> lattice;

/// Draws an index in proportion to the values; the number of values if all are 0.
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

/// Draws directions in proportion to the tables' S / mu, on a randomly shifted lattice.
void draw_from(const ScatteringGuide::Section& section, SlabRay* rays, std::size_t count, Rng& rng) {
  // Additive recurrence of the plastic number (Roberts 2018).
  constexpr double kFirst = 0.7548776662466927;
  constexpr double kSecond = 0.5698402909980532;
  const double shift = rng.uniform();
  double v = rng.uniform();
  double w = rng.uniform();
  for (std::size_t k = 0; k < count; ++k) {
    rays[k] = section.draw((static_cast<double>(k) + shift) / static_cast<double>(count), v, w);
    v += v + kFirst < 1.0 ? kFirst : kFirst - 1.0;
    w += w + kSecond < 1.0 ? kSecond : kSecond - 1.0;
  }
}

}  // namespace

GuidedDirections::GuidedDirections(const ScatteringGuide& guide, int candidates)
    : guide_(&guide), candidates_(candidates) {
  if (candidates != 8 && candidates != 16 && candidates != 32) {
    throw std::invalid_argument("candidates: must be 8, 16 or 32");
  }
}

template <int kOwn, int kDrawn>
GuidedDirections::Step GuidedDirections::among(const GuidedVertex& vertex, const LocalScattering& scattering,
                                               const SlabRay& from, const SlabRay& other, Rng& rng) const {
  constexpr int kAll = kOwn + kDrawn;
  using Values = Eigen::Array<float, kAll, 1>;
  const ScatteringGuide::Section section(*guide_, vertex.cell, vertex.up, vertex.t, other, scattering, rng.uniform(),
                                         rng.uniform());

  // Draw kOwn candidates from the phase function around `from`, and kDrawn from the tables
  const SlabFrame frame(from);
  const double shift = rng.uniform();
  const double turn = 2.0 * pi * rng.uniform();
  const double turn_cosine = std::cos(turn);
  const double turn_sine = std::sin(turn);
  std::array<SlabRay, kAll> rays;
  for (std::size_t k = 0; k < kOwn; ++k) {
    const double c = scattering.sample((static_cast<double>(k) + shift) / static_cast<double>(kOwn));
    const double s = std::sqrt(std::max(0.0, 1.0 - c * c));
    const double along = s * (turn_cosine * lattice.cosine[k] - turn_sine * lattice.sine[k]);
    const double aside = s * (turn_sine * lattice.cosine[k] + turn_cosine * lattice.sine[k]);
    rays[k] = frame.tilted(c, along, aside);
  }
  draw_from(section, &rays[kOwn], kDrawn, rng);

  // Compute k S~ / mu' over the candidates' density
  Values x;
  Values y;
  Values mu;
  for (std::size_t k = 0; k < kAll; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    x[i] = static_cast<float>(rays[k].x);
    y[i] = static_cast<float>(rays[k].y);
    mu[i] = static_cast<float>(rays[k].mu);
  }
  const Values light = section(x, y, mu);
  Values value = light;
  const double albedo = scattering.albedo();
  constexpr double kSphere = 1.0 / (4.0 * pi);
  Values drawn = Values::Zero();
  if constexpr (kDrawn > 0) {
    drawn = section.density(x, y, mu);
    const Values k = scattering.evaluate_all(
        Values(static_cast<float>(from.x) * x + static_cast<float>(from.y) * y + static_cast<float>(from.mu) * mu));
    const Values own = static_cast<float>(kSphere / albedo) * k;
    value = value * own / (static_cast<float>(kOwn) * own + static_cast<float>(kDrawn) * drawn);
  } else {
    value *= 1.0F / static_cast<float>(kOwn);
  }

  // Resample one candidate
  const std::size_t chosen = choose(value, rng);
  if (chosen == kAll) {
    return {from, 0.0, 0.0};
  }
  const SlabRay& ray = rays[chosen];
  const double own = kSphere * scattering.evaluate(passed_on(from, ray)) / albedo;
  const double density = kOwn * own + kDrawn * static_cast<double>(drawn[static_cast<Eigen::Index>(chosen)]);
  const double odds = static_cast<double>(value[static_cast<Eigen::Index>(chosen)] / value.sum());
  return {ray, albedo * own / (density * odds * ray.mu),
          static_cast<double>(light[static_cast<Eigen::Index>(chosen)]) * ray.mu};
}

GuidedDirections::Pair GuidedDirections::both_sides(const GuidedVertex& vertex, const LocalScattering& scattering,
                                                    const SlabRay& a, const SlabRay& b, Rng& rng) const {
  constexpr int kSides = 8;  // candidates for each side, 64 pairs
  using Values = Eigen::Array<float, kSides, 1>;
  std::array<std::array<SlabRay, kSides>, 2> rays;
  std::array<Values, 2> x;
  std::array<Values, 2> y;
  std::array<Values, 2> mu;
  std::array<Values, 2> density;
  std::array<Values, 2> light;
  std::array<Values, 2> share;

  // Draw candidates for each side from the tables
  const SlabRay* sides[2] = {&a, &b};
  for (std::size_t side = 0; side < 2; ++side) {
    const ScatteringGuide::Section section(*guide_, vertex.cell, vertex.up, vertex.t, *sides[side], scattering,
                                           rng.uniform(), rng.uniform());
    draw_from(section, rays[side].data(), kSides, rng);
    for (std::size_t k = 0; k < kSides; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      x[side][i] = static_cast<float>(rays[side][k].x);
      y[side][i] = static_cast<float>(rays[side][k].y);
      mu[side][i] = static_cast<float>(rays[side][k].mu);
    }
    density[side] = section.density(x[side], y[side], mu[side]);
    light[side] = section(x[side], y[side], mu[side]);
    share[side] = light[side] / density[side];
  }

  // Resample one of all pairs in proportion to S k S
  using Pairs = Eigen::Array<float, kSides * kSides, 1>;
  Pairs cosine;
  Pairs value;
  for (Eigen::Index i = 0; i < kSides; ++i) {
    cosine.segment<kSides>(i * kSides) = x[0][i] * x[1] + y[0][i] * y[1] - mu[0][i] * mu[1];
    value.segment<kSides>(i * kSides) = share[0][i] * share[1];
  }
  value *= scattering.evaluate_all(cosine);
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
  const double weight = scattering.evaluate(turned_back(p, q)) / (16.0 * pi * pi * p.mu * q.mu * both * odds);
  return {p, q, weight, static_cast<double>(light[0][static_cast<Eigen::Index>(i)]) * p.mu,
          static_cast<double>(light[1][static_cast<Eigen::Index>(j)]) * q.mu};
}

GuidedDirections::Step GuidedDirections::one_side(const GuidedVertex& vertex, const LocalScattering& scattering,
                                                  const SlabRay& from, const SlabRay& other, Rng& rng) const {
  switch (candidates_) {
    case 8:
      return among<4, 4>(vertex, scattering, from, other, rng);
    case 16:
      return among<12, 4>(vertex, scattering, from, other, rng);
    default:
      return among<24, 8>(vertex, scattering, from, other, rng);
  }
}

}  // namespace lamina
