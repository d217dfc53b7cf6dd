// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/layer_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "events/survival.hpp"
#include "matter/graded_single_scattering.hpp"
#include "matter/single_scattering_shape.hpp"
#include "solve/evaluation.hpp"
#include "solve/sound_solution.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Tolerance of the layer's solution, below the noise of walks.
constexpr double kSolvedTo = 2e-4;
/// Replaces a cosine of 0.
constexpr double kLeastCosine = 1e-6;
/// Least cosine at which a table is compared with the solution.
constexpr double kLeastCompared = 0.05;

/// Weights of cubic Lagrange interpolation on four points of a uniform grid, at `x` from the first.
std::array<double, 4> cubic_weights(double x) {
  return {-(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0, x * (x - 2.0) * (x - 3.0) / 2.0, -x * (x - 1.0) * (x - 3.0) / 2.0,
          x * (x - 1.0) * (x - 2.0) / 6.0};
}

/// The cosine of the azimuth between two rays.
double cosine_between(const Ray& a, const Ray& b) {
  const double lengths = (a.x * a.x + a.y * a.y) * (b.x * b.x + b.y * b.y);
  return lengths > 0.0 ? std::clamp((a.x * b.x + a.y * b.y) / std::sqrt(lengths), -1.0, 1.0) : 1.0;
}

/// Knots in the polar angle are denser towards grazing, where the scattering function of a thin layer varies over small
/// cosines: the angle is u (1 + c - c u) right angles, with u uniform and c = kBend.
constexpr double kBend = 0.6;

double knot_cosine(double knot, double last) {
  const double u = knot / last;
  return std::max(kLeastCosine, std::cos(0.5 * pi * u * (1.0 + kBend - kBend * u)));
}

/// The inverse of knot_cosine.
double knot_of_cosine(double mu, double last) {
  const double share = std::acos(std::min(mu, 1.0)) / (0.5 * pi);
  constexpr double kHalf = 0.5 * (1.0 + kBend);
  return last * (kHalf - std::sqrt(std::max(0.0, kHalf * kHalf - kBend * share))) / kBend;
}

/// Knots in azimuth are denser by this factor near dphi = 0, where phase functions have peaks, and sparser near pi:
/// tan(dphi / 2) is scaled by the factor, which keeps functions even about both ends.
constexpr double kAhead = 0.6;

double knot_azimuth(double knot, double last) {
  return knot < last ? 2.0 * std::atan(kAhead * std::tan(0.5 * pi * knot / last)) : pi;
}

/// The positions of all knots.
struct Edges {
  std::array<double, LayerTable::kAngles> cosine;
  std::array<double, LayerTable::kAzimuths> azimuth;

  Edges() {
    for (std::size_t k = 0; k < cosine.size(); ++k) {
      cosine[k] = knot_cosine(static_cast<double>(k), LayerTable::kAngles - 1);
    }
    for (std::size_t k = 0; k < azimuth.size(); ++k) {
      azimuth[k] = knot_azimuth(static_cast<double>(k), LayerTable::kAzimuths - 1);
    }
  }
};

/// Made on the first call: code at the start of the program would run before the check of the processor.
const Edges& edges() {
  static const Edges made;
  return made;
}

/// The inverse of knot_azimuth, from the cosine of the azimuth.
double knot_of_azimuth(double cosine, double last) {
  return last * (2.0 / pi) * std::atan2(std::sqrt(1.0 - cosine), kAhead * std::sqrt(1.0 + cosine));
}

Eigen::VectorXd middle_cosines() {
  Eigen::VectorXd mu(LayerTable::kAngles - 1);
  for (Eigen::Index k = 0; k < mu.size(); ++k) {
    mu[k] = knot_cosine(static_cast<double>(k) + 0.5, LayerTable::kAngles - 1);
  }
  return mu;
}

/// The midpoints between knots, where cubics are least accurate, down to kLeastCompared, and kLeastCompared.
Eigen::VectorXd compared_cosines() {
  std::vector<double> all;
  for (const double mu : middle_cosines()) {
    if (mu > kLeastCompared) {
      all.push_back(mu);
    }
  }
  all.push_back(kLeastCompared);
  return Eigen::Map<const Eigen::VectorXd>(all.data(), std::ssize(all));
}

Eigen::VectorXd compared_azimuths() {
  constexpr std::array kRanges = {0.0, 2.0, 4.0, 8.0, 16.0, 32.0, 48.0, 62.0};
  Eigen::VectorXd all(std::ssize(kRanges));
  for (std::size_t k = 0; k < kRanges.size(); ++k) {
    all[static_cast<Eigen::Index>(k)] = knot_azimuth(kRanges[k] + 0.5, LayerTable::kAzimuths - 1);
  }
  return all;
}

}  // namespace

/// A layer's solution and its values for the tables, [2 side + way].
struct LayerTable::Solved {
  Solution solution;
  std::vector<Side> sides;
  std::vector<std::vector<double>> at_knots;
  std::vector<std::vector<double>> between;

  Solved(const Stack& layer, std::vector<Side> entered, ThreadPool& pool)
      : solution(solve(layer, kSolvedTo, pool)), sides(std::move(entered)) {
    std::vector<Passage> passages;
    for (const Side side : sides) {
      passages.push_back({side, Path::kReflect});
      passages.push_back({side, Path::kTransmit});
    }
    const Eigen::VectorXd mu = Eigen::Map<const Eigen::VectorXd>(edges().cosine.data(), kAngles);
    const Eigen::VectorXd azimuths = Eigen::Map<const Eigen::VectorXd>(edges().azimuth.data(), kAzimuths);
    at_knots = evaluate_grids(solution, passages, mu, mu, azimuths, pool);
    const Eigen::VectorXd compared = compared_cosines();
    between = evaluate_grids(solution, passages, compared, compared, compared_azimuths(), pool);
  }
};

LayerTable::LayerTable(const Medium& medium, ThreadPool& pool) : medium_(medium) {
  lay(Solved(Stack{{medium}, {}}, {Side::kTop}, pool), 0, pool);
}

std::array<LayerTable, 2> LayerTable::both_sides(const GradedMedium& graded, ThreadPool& pool) {
  const Solved solved(Stack{{graded}, {}}, {Side::kTop, Side::kBottom}, pool);
  return {LayerTable(graded, solved, 0, pool), LayerTable(graded.turned(), solved, 1, pool)};
}

LayerTable::LayerTable(const GradedMedium& graded, const Solved& solved, std::size_t side, ThreadPool& pool)
    : medium_{graded.largest_albedo(), graded.tau(), PhaseFunction()}, graded_(graded) {
  lay(solved, side, pool);
}

void LayerTable::lay(const Solved& solved, std::size_t side, ThreadPool& pool) {
  for (const Way way : {kReflected, kPassed}) {
    const std::vector<double>& exact = solved.at_knots[2 * side + way];
    table_[way].resize(exact.size());
    pool.run(kAngles, [&](std::size_t row) {
      const double o = edges().cosine[row];
      std::size_t place = row * kAngles * kAzimuths;
      for (const double i : edges().cosine) {
        for (const double azimuth : edges().azimuth) {
          table_[way][place] = static_cast<float>((exact[place] - once(way, o, i, std::cos(azimuth))) * (o + i));
          ++place;
        }
      }
    });
  }
  const Fluxes flux = fluxes(solved.solution, solved.sides[side], middle_cosines(), pool);
  lay_sampling(pool, flux.reflected + flux.transmitted);
  compare(solved, side);
}

void LayerTable::compare(const Solved& solved, std::size_t side) {
  const Eigen::VectorXd mu = compared_cosines();
  const Eigen::VectorXd azimuths = compared_azimuths();
  for (const Way way : {kReflected, kPassed}) {
    auto exact = solved.between[2 * side + way].begin();
    for (const double o : mu) {
      for (const double i : mu) {
        for (const double azimuth : azimuths) {
          const double cosine = std::cos(azimuth);
          const double difference = once(way, o, i, cosine) + repeated(way, o, i, cosine) - *exact;
          if (*exact > 0.0) {
            error_ = std::max(error_, std::abs(difference) / *exact);
          }
          ++exact;
        }
      }
    }
  }
  error_ += solved.solution.checks().resolution;
}

LayerTable::Stencil LayerTable::angle_stencil(double mu) {
  const double x = knot_of_cosine(mu, kAngles - 1);
  const auto first = static_cast<std::size_t>(std::clamp(std::floor(x) - 1.0, 0.0, kAngles - 4.0));
  return {{first, first + 1, first + 2, first + 3}, cubic_weights(x - static_cast<double>(first))};
}

LayerTable::Stencil LayerTable::azimuth_stencil(double cosine) {
  // Functions are even about both ends.
  constexpr std::size_t kLast = kAzimuths - 1;
  const double x = knot_of_azimuth(cosine, kLast);
  const auto here = std::min(static_cast<std::size_t>(x), kLast - 1);
  const std::size_t before = here == 0 ? 1 : here - 1;
  const std::size_t after = here + 2 > kLast ? kLast - 1 : here + 2;
  return {{before, here, here + 1, after}, cubic_weights(x - static_cast<double>(here) + 1.0)};
}

std::size_t LayerTable::range_of(double mu) {
  const double x = knot_of_cosine(mu, kAngles - 1);
  return std::min(static_cast<std::size_t>(x), kAngles - 2);
}

double LayerTable::repeated(Way way, double mu_o, double mu_i, double cosine) const {
  const Stencil o = angle_stencil(mu_o);
  const Stencil i = angle_stencil(mu_i);
  const Stencil p = azimuth_stencil(cosine);
  double sum = 0.0;
  for (std::size_t a = 0; a < 4; ++a) {
    double inner = 0.0;
    for (std::size_t b = 0; b < 4; ++b) {
      const float* row = table_[way].data() + (o.at[a] * kAngles + i.at[b]) * kAzimuths;
      inner += i.weights[b] * (p.weights[0] * row[p.at[0]] + p.weights[1] * row[p.at[1]] + p.weights[2] * row[p.at[2]] +
                               p.weights[3] * row[p.at[3]]);
    }
    sum += o.weights[a] * inner;
  }
  return sum / (mu_o + mu_i);
}

double LayerTable::once(Way way, double mu_o, double mu_i, double cosine) const {
  const double across = sine_of(mu_o) * sine_of(mu_i) * cosine;
  const bool turned = way == kReflected;
  if (graded_) {
    const double angle = std::clamp(across + (turned ? -mu_o : mu_o) * mu_i, -1.0, 1.0);
    return scattered_once(*graded_, !turned, mu_o, mu_i, angle) / (4.0 * pi);
  }
  const double shape =
      turned ? single_reflection(mu_o, mu_i, medium_.tau) : single_transmission(mu_o, mu_i, medium_.tau);
  const double angle = std::clamp(across + (turned ? -mu_o : mu_o) * mu_i, -1.0, 1.0);
  return medium_.albedo / (4.0 * pi) * medium_.phase.evaluate(angle) * shape;
}

double LayerTable::value(const Ray& in, const Ray& out) const {
  const Way way = (in.z < 0.0) != (out.z < 0.0) ? kReflected : kPassed;
  const double mu_o = std::max(kLeastCosine, std::abs(out.z));
  const double mu_i = std::max(kLeastCosine, std::abs(in.z));
  const double cosine = cosine_between(in, out);
  return once(way, mu_o, mu_i, cosine) + repeated(way, mu_o, mu_i, cosine);
}

void LayerTable::lay_sampling(ThreadPool& pool, const Eigen::VectorXd& scattered_flux) {
  // Uniform share of the density, which bounds the weights.
  constexpr double kFloor = 0.05;
  constexpr std::size_t kRanges = kAngles - 1;
  constexpr std::size_t kSectors = kAzimuths - 1;
  sampling_.resize(kRanges);
  pool.run(kRanges, [&](std::size_t incident) {
    Sampling& sampling = sampling_[incident];
    const double mu_i = knot_cosine(static_cast<double>(incident) + 0.5, kRanges);
    for (const Way way : {kReflected, kPassed}) {
      std::vector<double>& until = sampling.until[way];
      std::vector<double> shares;
      double whole = 0.0;
      for (std::size_t a = 0; a < kRanges; ++a) {
        const double mu_o = knot_cosine(static_cast<double>(a) + 0.5, kRanges);
        const double width = edges().cosine[a] - edges().cosine[a + 1];
        const float* corners = table_[way].data() + (a * kAngles + incident) * kAzimuths;
        for (std::size_t p = 0; p < kSectors; ++p) {
          double mean = 0.0;
          for (const std::size_t corner : {p, p + kAzimuths, p + kAngles * kAzimuths, p + (kAngles + 1) * kAzimuths}) {
            mean += 0.125 * (corners[corner] + corners[corner + 1]);
          }
          const double solid = 2.0 * mu_o * width * (edges().azimuth[p + 1] - edges().azimuth[p]);
          shares.push_back(solid * std::max(0.0, mean / (mu_o + mu_i)));
          until.push_back(solid);
          whole += shares.back();
        }
      }
      sampling.repeated[way] = whole;
      double sum = 0.0;
      for (std::size_t k = 0; k < until.size(); ++k) {
        // The projected solid angles sum to pi.
        sum += whole > 0.0 ? (1.0 - kFloor) * shares[k] / whole + kFloor * until[k] / pi : 0.0;
        until[k] = sum;
      }
    }
    constexpr double kLeastShare = 0.02;  // least probability of single scattering, which bounds the weights
    const double again = sampling.repeated[kReflected] + sampling.repeated[kPassed];
    const double all = scattered_flux[static_cast<Eigen::Index>(incident)];
    sampling.once = std::max(all - again, kLeastShare * all);
  });
}

double LayerTable::unscattered(const Ray& in) const { return std::exp(-medium_.tau / std::abs(in.z)); }

double LayerTable::scattered(const Ray& in) const {
  const Sampling& sampling = sampling_[range_of(std::abs(in.z))];
  return sampling.once + sampling.repeated[kReflected] + sampling.repeated[kPassed];
}

bool LayerTable::cross(Ray& ray, double& weight, bool first, Rng& rng) const {
  const Sampling& sampling = sampling_[range_of(std::abs(ray.z))];
  const double passing = first ? 0.0 : unscattered(ray);
  const double scattering = sampling.once + sampling.repeated[kReflected] + sampling.repeated[kPassed];
  // The remaining probability is absorption. The tables' sum may exceed 1.
  const double whole = first ? scattering : std::max(1.0, passing + scattering);
  double choice = rng.uniform() * whole;
  if (!first) {
    weight *= whole;
  }
  if (choice < passing) {
    return survives(weight, rng);
  }
  choice -= passing;
  if (choice < sampling.once) {
    weight /= sampling.once;
    return scatter_once(ray, weight, rng);
  }
  choice -= sampling.once;
  for (const Way way : {kReflected, kPassed}) {
    if (choice < sampling.repeated[way]) {
      weight /= sampling.repeated[way];
      return scatter_again(way, sampling, ray, weight, rng);
    }
    choice -= sampling.repeated[way];
  }
  return false;
}

bool LayerTable::scatter_once(Ray& ray, double& weight, Rng& rng) const {
  const double mu = std::abs(ray.z);
  const double passing = unscattered(ray);
  const double length = -std::log(passing + (1.0 - passing) * rng.uniform());
  const double covered = std::min(length * mu, medium_.tau);  // from the face of entry
  const bool down = ray.z < 0.0;
  weight *= 1.0 - passing;
  if (graded_) {
    const LocalScattering local = graded_->at_depth(covered);
    weight *= local.albedo();
    if (weight == 0.0) {
      return false;
    }
    ray = lamina::scattered(ray, local.sample(rng.uniform()), rng);
  } else {
    weight *= medium_.albedo;
    ray = lamina::scattered(ray, medium_.phase.sample(rng.uniform()), rng);
  }
  const double left = (ray.z < 0.0) == down ? medium_.tau - covered : covered;
  weight *= std::exp(-left / std::abs(ray.z));
  return weight != 0.0 && survives(weight, rng);
}

bool LayerTable::scatter_again(Way way, const Sampling& sampling, Ray& ray, double& weight, Rng& rng) const {
  const std::vector<double>& until = sampling.until[way];
  const double u = rng.uniform() * until.back();
  const auto cell = static_cast<std::size_t>(std::lower_bound(until.begin(), until.end(), u) - until.begin());
  const double probability = (until[cell] - (cell > 0 ? until[cell - 1] : 0.0)) / until.back();
  constexpr std::size_t kSectors = kAzimuths - 1;
  const double upper = edges().cosine[cell / kSectors];
  const double lower = edges().cosine[cell / kSectors + 1];
  const double mu = lower + (upper - lower) * rng.uniform();
  const double begin = edges().azimuth[cell % kSectors];
  const double wide = edges().azimuth[cell % kSectors + 1] - begin;
  const double turn = begin + wide * rng.uniform();
  const double cosine = std::cos(turn);
  const double sine = std::copysign(sine_of(cosine), rng.uniform() - 0.5);
  // The factor 2 accounts for both signs of the azimuth.
  const double density = probability / (2.0 * (upper - lower) * wide);
  const double mu_i = std::max(kLeastCosine, std::abs(ray.z));
  weight *= repeated(way, mu, mu_i, cosine) * mu / density;
  const double across = std::hypot(ray.x, ray.y);
  const double x = across > 0.0 ? ray.x / across : 1.0;
  const double y = across > 0.0 ? ray.y / across : 0.0;
  const bool down = (ray.z < 0.0) == (way == kPassed);
  const double out = sine_of(mu);
  ray = {out * (x * cosine - y * sine), out * (y * cosine + x * sine), down ? -mu : mu};
  return weight != 0.0 && survives(weight, rng);
}

}  // namespace lamina
