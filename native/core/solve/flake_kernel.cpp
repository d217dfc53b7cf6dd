// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/flake_kernel.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

double sine_squared(double mu) { return std::max(0.0, (1.0 - mu) * (1.0 + mu)); }

/// N, P and Q of a pair of directions, see FlakeKernel, by the differences P - Q and N - P, which may be small.
struct Pair {
  double q;           ///< Q
  double narrowness;  ///< P - Q
  double excess;      ///< N - P

  Pair(double alpha, double mu_o, double mu_i, double turn) {
    const double sine_o = std::sqrt(sine_squared(mu_o));
    const double sine_i = std::sqrt(sine_squared(mu_i));
    const double height = turn < 0.0 ? mu_o + mu_i : mu_o - mu_i;
    const double sum = sine_o + sine_i;
    const double difference = sum > 0.0 ? (mu_i - mu_o) * (mu_i + mu_o) / sum : 0.0;
    q = 2.0 * sine_o * sine_i;
    narrowness = alpha * alpha * height * height + difference * difference;
    excess = (1.0 - alpha) * (1.0 + alpha) * height * height;
  }
};

/// Throws std::runtime_error unless the error of a fit, its root mean square over diffuse light, is a small share of
/// the mean `reflected`, for cosines with the distances of equidistant square roots.
void check_fit(const VectorXd& cosine, const VectorXd& reflected, const VectorXd& error) {
  constexpr double kLeastMean = 1e-3;
  constexpr double kAllowed = 0.05;  // light that flakes reflect repeatedly is then off by at most some .5 %
  const ArrayXd weight = cosine.array() * cosine.array().sqrt();
  const double mean = (weight * reflected.array()).sum() / weight.sum();
  if (mean < kLeastMean) {
    throw std::runtime_error(
        "flakes with films: they reflect next to nothing: the index of platelets must differ more "
        "from that of the binder");
  }
  const double found = std::sqrt((weight * error.array().square()).sum() / weight.sum()) / mean;
  if (!(found < kAllowed)) {
    throw std::runtime_error("flakes with films: what they reflect changes too fast with the angle: error " +
                             std::to_string(found) +
                             " (allowed 0.05); thinner films, or no index below that of the binder, can be solved");
  }
}

/// The Fresnel factor of flakes as a constant and poles in the square of the cosine.
struct FresnelFit {
  double constant = 1.0;
  std::vector<double> pole;  ///< t
  std::vector<double> weight;

  explicit FresnelFit(const Flakes& flakes) {
    if (!flakes.metal && !flakes.filmed) {
      return;
    }
    const int poles = flakes.filmed ? 28 : 12;
    const double first = flakes.filmed ? 1e-7 : 1e-6;
    const double ratio = flakes.filmed ? 2.0 : 4.0;
    constexpr Index kSamples = 400;
    constexpr double kLeastSeen = 1e-4;
    // Samples are dense at grazing incidence, where the factor rises steeply.
    const ArrayXd cosine = ArrayXd::LinSpaced(kSamples, 0.0, 1.0).square();
    for (int k = 0; k < poles; ++k) {
      pole.push_back(first * std::pow(ratio, k));
    }
    MatrixXd terms = MatrixXd::Ones(kSamples, poles + 1);
    for (Index k = 0; k < poles; ++k) {
      const double t = pole[static_cast<std::size_t>(k)];
      terms.col(k + 1) = t / (cosine.square() + t);
    }
    const VectorXd reflected = cosine.unaryExpr([&](double c) { return flakes.reflectance(c); });
    VectorXd wanted = reflected;
    if (flakes.filmed) {
      // Films may reflect little, of which errors are to be a small share.
      const VectorXd share = reflected.cwiseMax(kLeastSeen).cwiseInverse();
      terms = share.asDiagonal() * terms;
      wanted = share.cwiseProduct(reflected);
    }
    const VectorXd found = terms.colPivHouseholderQr().solve(wanted);
    if (flakes.filmed) {
      check_fit(cosine, reflected, (terms * found - wanted).cwiseProduct(reflected.cwiseMax(kLeastSeen)));
    }
    constant = found[0];
    for (Index k = 0; k < poles; ++k) {
      weight.push_back(found[k + 1] * pole[static_cast<std::size_t>(k)]);
    }
  }
};

/// log(Q / (P + S)) with S^2 = P^2 - Q^2 from P - Q: the logarithm of the ratio of successive orders.
double log_ratio(double q, double narrowness, double root) {
  constexpr double kNone = -1e4;  // orders above 0 vanish
  return q > 0.0 ? std::max(kNone, std::log1p(-(narrowness + root) / (q + narrowness + root))) : kNone;
}

double root_of(double q, double narrowness) { return std::sqrt(narrowness * (narrowness + 2.0 * q)); }

/// The mean of order 0 of white flakes, reflected and transmitted.
double white_mean(const Flakes& flakes, double mu_o, double mu_i) {
  double sum = 2.0;
  for (const double turn : {-1.0, 1.0}) {
    const Pair pair(flakes.alpha, mu_o, mu_i, turn);
    const double s = root_of(pair.q, pair.narrowness);
    if (s > 0.0) {
      const double e = pair.excess / s;
      sum += 2.0 * e + e * e * (pair.q + pair.narrowness) / s;
    }
  }
  return 0.5 * flakes.alpha * flakes.alpha * sum / (flakes.extinction(mu_o) * flakes.extinction(mu_i));
}

/// The error of equidistant nodes, one of them at 0, for the integral of |x| exp(-rate |x|), relative to that for rate
/// 0; `steps`: the rate times the distance of nodes.
double cusp_error(double steps) {
  if (steps < 1e-3) {
    return 1.0;
  }
  const double half = 0.5 * steps;
  const double ratio = half < 300.0 ? half / std::sinh(half) : 0.0;
  return 3.0 * (1.0 - ratio * ratio) / (half * half);
}

}  // namespace

double flake_phase(const Flakes& flakes, double mu_o, double mu_i, double turn, double azimuth) {
  const Pair pair(flakes.alpha, mu_o, mu_i, turn);
  const double y = pair.narrowness + pair.q * std::max(0.0, 1.0 - azimuth);
  const double square = y + pair.excess;
  // Equal directions: the limit for a difference in azimuth
  const double ratio = y > 0.0 ? square / y : 1.0;
  const double law = flakes.alpha * flakes.alpha * ratio * ratio;
  return law * flakes.reflectance(std::min(1.0, 0.5 * std::sqrt(square))) /
         (flakes.extinction(mu_o) * flakes.extinction(mu_i));
}

FlakeKernel::FlakeKernel(const Flakes& flakes, const Directions& directions) : targets_(directions.targets) {
  if (flakes.translucency) {
    matte_ = std::make_shared<MatteKernel>(flakes, directions);
    return;
  }
  const FresnelFit fresnel(flakes);
  const Index rows = directions.mu.size();
  const Index columns = directions.live;
  const VectorXd extinction = directions.mu.unaryExpr([&](double mu) { return flakes.extinction(mu); });
  const double square = flakes.alpha * flakes.alpha;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    Part& part = parts_[k];
    for (ArrayXXd* table : {&part.log_r, &part.flat, &part.rising, &part.steady}) {
      table->setZero(rows, columns);
    }
    part.log_q.assign(fresnel.pole.size(), ArrayXXd::Zero(rows, columns));
    part.share.assign(fresnel.pole.size(), ArrayXXd::Zero(rows, columns));
    for (Index j = 0; j < columns; ++j) {
      for (Index i = 0; i < rows; ++i) {
        const Pair pair(flakes.alpha, directions.mu[i], directions.mu[j], k == 0 ? -1.0 : 1.0);
        const double factor = square / (extinction[i] * extinction[j]);
        const double s = root_of(pair.q, pair.narrowness);
        const double p = pair.q + pair.narrowness;
        // E / S and so on, which vanish for equal directions
        const double e = s > 0.0 ? pair.excess / s : 0.0;
        part.log_r(i, j) = log_ratio(pair.q, pair.narrowness, s);
        double flat = fresnel.constant * (2.0 * e + e * e * (s > 0.0 ? p / s : 0.0));
        double rising = fresnel.constant * e * e;
        for (std::size_t n = 0; n < fresnel.pole.size(); ++n) {
          // (y + E)^2 / (y^2 (y + G)) in partial fractions, with y = P - Q x
          const double t = 4.0 * fresnel.pole[n];
          const double g = pair.excess + t;
          const double weight = 4.0 * fresnel.weight[n];
          const double c = t * t / (g * g);
          const double a = pair.excess * (g + t) / (g * g);  // 1 - c
          const double wide = pair.narrowness + g;
          const double root = root_of(pair.q, wide);
          flat += s > 0.0 ? weight * (a / s + e * e * p / (g * s)) : 0.0;
          rising += weight * e * e / g;
          part.log_q[n](i, j) = log_ratio(pair.q, wide, root);
          part.share[n](i, j) = factor * weight * c / root;
        }
        part.flat(i, j) = factor * flat;
        part.rising(i, j) = factor * rising;
        part.steady(i, j) = factor * fresnel.constant;
      }
    }
    part.sort();
  }
  correction_.resize(columns);
  cusp_.resize(columns);
  for (Index i = 0; i < columns; ++i) {
    double found = 0.0;
    for (Index j = 0; j < columns; ++j) {
      found += white_mean(flakes, directions.mu[i], directions.mu[j]) * extinction[j] * directions.weight[j];
    }
    const double mu = directions.mu[i];
    correction_[i] = 2.0 * (flakes.area(mu) / extinction[i] - found) / (extinction[i] * directions.weight[i]);
    const double sine = std::sqrt(sine_squared(mu));
    cusp_[i] = directions.weight[i] * std::hypot(flakes.alpha, mu / sine) / sine;
  }
  if (flakes.filmed) {
    const PhaseKernel mean = order(0);
    const VectorXd weight = extinction.head(columns).cwiseProduct(directions.weight.head(columns));
    const VectorXd found = 0.5 * (mean.reflect + mean.transmit).topLeftCorner(columns, columns) * weight;
    misfit_.resize(columns);
    for (Index i = 0; i < columns; ++i) {
      const double wanted = flakes.filmed->reflecting_area(directions.mu[i]) / extinction[i];
      misfit_[i] = 2.0 * (wanted - found[i]) / weight[i];
    }
  }
}

void FlakeKernel::Part::sort() {
  place.resize(static_cast<std::size_t>(log_r.size()));
  std::iota(place.begin(), place.end(), Index{0});
  std::stable_sort(place.begin(), place.end(), [&](Index a, Index b) { return log_r(a) > log_r(b); });
  const auto put_in_order = [&](ArrayXXd& table) { table = table.reshaped()(place).eval(); };
  for (ArrayXXd* table : {&log_r, &flat, &rising}) {
    put_in_order(*table);
  }
  for (std::vector<ArrayXXd>* tables : {&log_q, &share}) {
    std::ranges::for_each(*tables, put_in_order);
  }
}

MatrixXd FlakeKernel::order_of(const Part& part, int m) const {
  constexpr double kNothing = -50.0;  // 2e-22
  const double order = m;
  const Index lasting = (order * part.log_r >= kNothing).count();
  const auto powers = [&](const ArrayXXd& log) { return (order * log.topRows(lasting)).exp(); };
  ArrayXXd sum = powers(part.log_r) * (part.flat.topRows(lasting) + order * part.rising.topRows(lasting));
  for (std::size_t n = 0; n < part.share.size(); ++n) {
    sum += part.share[n].topRows(lasting) * powers(part.log_q[n]);
  }
  const Index rows = part.steady.rows();
  const Index columns = part.steady.cols();
  MatrixXd all = MatrixXd::Zero(rows, rows);
  if (m == 0) {
    all.leftCols(columns) = part.steady.matrix();
  }
  for (Index k = 0; k < lasting; ++k) {
    all.data()[part.place[static_cast<std::size_t>(k)]] += sum(k);
  }
  all.topRightCorner(columns, targets_) = all.bottomLeftCorner(targets_, columns).transpose();
  return all;
}

PhaseKernel FlakeKernel::order(int m) const {
  if (matte_) {
    return matte_->order(m);
  }
  PhaseKernel kernel(order_of(parts_[0], m), order_of(parts_[1], m));
  for (Index i = 0; i < correction_.size(); ++i) {
    kernel.transmit(i, i) += correction_[i] * cusp_error(m * cusp_[i]);
  }
  if (m == 0 && misfit_.size() > 0) {
    kernel.transmit.diagonal().head(misfit_.size()) += misfit_;
  }
  return kernel;
}

}  // namespace lamina
