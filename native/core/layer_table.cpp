// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "evaluation.hpp"
#include "graded_single.hpp"
#include "single_scattering.hpp"
#include "solution.hpp"
#include "survival.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Finer than any walk will notice.
constexpr double kTolerance = 2e-4;
constexpr double kLeastCosine = 1e-6;

/// Cubic of Lagrange on four neighbours of a uniform grid, `x` from the first of them.
std::array<double, 4> cubic_weights(double x) {
  return {-(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0, x * (x - 2.0) * (x - 3.0) / 2.0, -x * (x - 1.0) * (x - 3.0) / 2.0,
          x * (x - 1.0) * (x - 2.0) / 6.0};
}

/// Cosine of the difference of azimuths of two rays.
double cosine_between(const Ray& a, const Ray& b) {
  const double lengths = (a.x * a.x + a.y * a.y) * (b.x * b.x + b.y * b.y);
  return lengths > 0.0 ? std::clamp((a.x * b.x + a.y * b.y) / std::sqrt(lengths), -1.0, 1.0) : 1.0;
}

double knot_cosine(double knot, double last) { return std::max(kLeastCosine, std::cos(0.5 * pi * knot / last)); }

}  // namespace

LayerTable::LayerTable(const Medium& medium, ThreadPool& pool) : medium_(medium) { lay(Stack{{medium}, {}}, pool); }

LayerTable::LayerTable(const GradedMedium& graded, ThreadPool& pool)
    : medium_{graded.largest_albedo(), graded.tau(), PhaseFunction()}, graded_(graded) {
  lay(Stack{{graded}, {}}, pool);
}

void LayerTable::lay(const Stack& layer, ThreadPool& pool) {
  const Solution solution = solve(layer, kTolerance, pool);
  Eigen::VectorXd mu(kAngles);
  Eigen::VectorXd middle(kAngles - 1);
  Eigen::VectorXd azimuths(kAzimuths);
  for (std::size_t k = 0; k < kAngles; ++k) {
    mu[static_cast<Eigen::Index>(k)] = knot_cosine(static_cast<double>(k), kAngles - 1);
  }
  for (Eigen::Index k = 0; k < middle.size(); ++k) {
    middle[k] = knot_cosine(static_cast<double>(k) + 0.5, kAngles - 1);
  }
  for (std::size_t p = 0; p < kAzimuths; ++p) {
    azimuths[static_cast<Eigen::Index>(p)] = pi * static_cast<double>(p) / (kAzimuths - 1);
  }
  for (const Way way : {kReflected, kPassed}) {
    const Path path = way == kReflected ? Path::kReflect : Path::kTransmit;
    table_[way] = evaluate_grid(solution, Side::kTop, path, mu, mu, azimuths, pool);
    std::size_t place = 0;
    for (const double o : mu) {
      for (const double i : mu) {
        for (const double azimuth : azimuths) {
          double& entry = table_[way][place++];
          entry = (entry - once(way, o, i, std::cos(azimuth))) * (o + i);
        }
      }
    }
  }
  const Fluxes flux = fluxes(solution, Side::kTop, middle, pool);
  lay_sampling(pool, flux.reflected + flux.transmitted);

  // The middles of all ranges of angles and azimuths, where cubics are worst, with every incidence once.
  constexpr Eigen::Index kPoints = 200;
  Eigen::VectorXd o(kPoints);
  Eigen::VectorXd i(kPoints);
  Eigen::VectorXd azimuth(kPoints);
  const Eigen::Index ranges = middle.size() - 2;  // the last two lie below .05
  for (Eigen::Index k = 0; k < kPoints; ++k) {
    o[k] = middle[(7 * k) % ranges];
    i[k] = middle[(11 * k + k / ranges) % ranges];
    azimuth[k] = pi * (static_cast<double>((5 * k) % (kAzimuths - 1)) + 0.5) / (kAzimuths - 1);
  }
  for (const Way way : {kReflected, kPassed}) {
    const Path path = way == kReflected ? Path::kReflect : Path::kTransmit;
    const std::vector<double> exact = evaluate_points(solution, Side::kTop, path, o, i, azimuth, pool);
    for (Eigen::Index k = 0; k < kPoints; ++k) {
      const double cosine = std::cos(azimuth[k]);
      const double difference =
          once(way, o[k], i[k], cosine) + repeated(way, o[k], i[k], cosine) - exact[static_cast<std::size_t>(k)];
      if (exact[static_cast<std::size_t>(k)] > 0.0) {
        error_ = std::max(error_, std::abs(difference) / exact[static_cast<std::size_t>(k)]);
      }
    }
  }
}

LayerTable::Stencil LayerTable::angle_stencil(double mu) {
  const double x = std::acos(std::min(mu, 1.0)) / (0.5 * pi) * (kAngles - 1);
  const auto first = static_cast<std::size_t>(std::clamp(std::floor(x) - 1.0, 0.0, kAngles - 4.0));
  return {{first, first + 1, first + 2, first + 3}, cubic_weights(x - static_cast<double>(first))};
}

LayerTable::Stencil LayerTable::azimuth_stencil(double cosine) {
  // Even about both ends.
  constexpr std::size_t kLast = kAzimuths - 1;
  const double x = std::acos(cosine) / pi * kLast;
  const auto here = std::min(static_cast<std::size_t>(x), kLast - 1);
  const std::size_t before = here == 0 ? 1 : here - 1;
  const std::size_t after = here + 2 > kLast ? kLast - 1 : here + 2;
  return {{before, here, here + 1, after}, cubic_weights(x - static_cast<double>(here) + 1.0)};
}

std::size_t LayerTable::range_of(double mu) {
  const double x = std::acos(std::min(mu, 1.0)) / (0.5 * pi) * (kAngles - 1);
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
      const double* row = table_[way].data() + (o.at[a] * kAngles + i.at[b]) * kAzimuths;
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
  // At least this share of the mean density everywhere, so that no weight is large.
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
        const double width =
            knot_cosine(static_cast<double>(a), kRanges) - knot_cosine(static_cast<double>(a) + 1.0, kRanges);
        for (std::size_t p = 0; p < kSectors; ++p) {
          const double cosine = std::cos(pi * (static_cast<double>(p) + 0.5) / kSectors);
          const double solid = 2.0 * mu_o * width * pi / kSectors;
          shares.push_back(solid * std::max(0.0, repeated(way, mu_o, mu_i, cosine)));
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
    constexpr double kLeastShare = 0.02;
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
  // What is left of 1 is absorbed; tables may leave less than nothing.
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
  const double covered = std::min(length * mu, medium_.tau);  // from the face where it came in
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
  const double angle = static_cast<double>(cell / kSectors);
  const double upper = knot_cosine(angle, kAngles - 1);
  const double lower = knot_cosine(angle + 1.0, kAngles - 1);
  const double mu = lower + (upper - lower) * rng.uniform();
  const double turn = pi * (static_cast<double>(cell % kSectors) + rng.uniform()) / kSectors;
  const double cosine = std::cos(turn);
  const double sine = std::copysign(sine_of(cosine), rng.uniform() - 0.5);
  // Both signs of the azimuth.
  const double density = probability / (2.0 * (upper - lower) * pi / kSectors);
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
