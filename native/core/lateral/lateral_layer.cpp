// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/lateral_layer.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "solve/normalising_share.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFaintest = 1e-9;  // media of smaller albedo count as not scattering

/// The operators G and H of a layer; see LateralMedium.
struct HalfLayer {
  MatrixXd g;
  MatrixXd h;
};

/// The largest optical thickness over cosine of half a layer that is computed without doubling.
constexpr double kThin = 6.0;
constexpr int kOrder = 8;

/// Coefficients of powers of x^2 in the Pade approximant of tanh(x) / x that follows from the approximant of order 2
/// kOrder + 1 of exp(2 x). The relative error for x = kThin is 1e-11, and smaller for smaller x.
struct TanhCoefficients {
  std::array<double, kOrder + 1> numerator{};
  std::array<double, kOrder + 1> denominator{};

  TanhCoefficients() {
    constexpr int kDegree = 2 * kOrder + 1;
    double c = 1.0;
    for (int j = 0; j <= kDegree; ++j) {
      (j % 2 == 0 ? denominator : numerator)[static_cast<std::size_t>(j / 2)] = c;
      c *= 2.0 * (kDegree - j) / ((2.0 * kDegree - j) * (j + 1.0));
    }
  }
};

/// The polynomial with these coefficients from y^1 to y^4, by one product (Paterson and Stockmeyer 1973).
MatrixXd polynomial(const std::array<double, kOrder + 1>& c, const std::array<MatrixXd, kOrder / 2>& powers) {
  constexpr std::size_t kHalf = kOrder / 2;
  MatrixXd low = c[1] * powers[0];
  MatrixXd high = c[kHalf + 1] * powers[0];
  for (std::size_t k = 2; k <= kHalf; ++k) {
    if (k < kHalf) {
      low += c[k] * powers[k - 1];
    }
    high += c[kHalf + k] * powers[k - 1];
  }
  low.diagonal().array() += c[0];
  high.diagonal().array() += c[kHalf];
  low.noalias() += powers.back() * high;
  return low;
}

HalfLayer thin_layer(const MatrixXd& a, const MatrixXd& b, double half) {
  static const TanhCoefficients coefficients;
  std::array<MatrixXd, kOrder / 2> powers;
  powers[0].noalias() = (half * half) * a * b;
  powers[1].noalias() = powers[0] * powers[0];
  powers[2].noalias() = powers[0] * powers[1];
  powers[3].noalias() = powers[1] * powers[1];
  const MatrixXd f =
      half *
      polynomial(coefficients.denominator, powers).partialPivLu().solve(polynomial(coefficients.numerator, powers));
  return {b * f, f * a};
}

/// Doubles the thickness of a layer: tanh(2 x) = 2 tanh(x) / (1 + tanh(x)^2). Returns false if the layer was so thick
/// that nothing is transmitted any more.
bool redouble(HalfLayer& layer) {
  constexpr double kNothing = 1e-9;  // the doubled layer transmits the square
  MatrixXd square = layer.h * layer.g;
  square.diagonal().array() += 1.0;
  const double missing = (0.5 * square - MatrixXd::Identity(square.rows(), square.cols())).cwiseAbs().maxCoeff();
  const Eigen::PartialPivLU<MatrixXd> sum(square);
  layer.h *= 2.0;
  layer.h = sum.solve(layer.h).eval();
  // G (1 + H G)^-1 with the factors P (1 + H G) = L U.
  layer.g *= 2.0;
  sum.matrixLU().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(layer.g);
  sum.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace<Eigen::OnTheRight>(layer.g);
  layer.g = (layer.g * sum.permutationP()).eval();
  return missing > kNothing;
}

struct LayerPair {
  MatrixXd reflect;
  MatrixXd transmit;
};

LayerPair whole_layer(const HalfLayer& layer) {
  // (1 - G) (1 + G)^-1 = 2 (1 + G)^-1 - 1, and likewise for H.
  const MatrixXd one = MatrixXd::Identity(layer.g.rows(), layer.g.cols());
  const MatrixXd alike = (one + layer.g).partialPivLu().inverse();
  const MatrixXd opposite = (one + layer.h).partialPivLu().inverse();
  return {alike - opposite, alike + opposite - one};
}

}  // namespace

LateralMedium::LateralMedium(const Medium& medium, int moments, const Directions& directions, double extinction,
                             double thickness)
    : medium_(medium, moments),
      phase_(medium.phase),
      directions_(directions),
      extinction_(extinction * (1.0 - medium.albedo * medium_.forward_share)),
      thickness_(thickness),
      whole_tau_(medium.tau),
      scatters_(medium_.albedo > kFaintest && medium_.tau > 0.0) {
  sine_ = (1.0 - directions.mu.array().square()).max(0.0).sqrt();
  if (!scatters_) {
    return;
  }
  const VectorXd steep = directions.scale.cwiseQuotient(directions.mu) / std::sqrt(2.0);
  const Index live = directions.live;
  const VectorXd root = directions.weight.cwiseSqrt();
  for (int m = 0; m < moments; ++m) {
    const PhaseKernel phase(medium_, m, directions.mu);
    MatrixXd even = 0.5 * (phase.transmit + phase.reflect);
    const MatrixXd odd = 0.5 * (phase.transmit - phase.reflect);
    if (m == 0) {
      const MatrixXd share =
          normalising_share(root.asDiagonal() * even.topLeftCorner(live, live) * root.asDiagonal(), root);
      even.topLeftCorner(live, live) += root.cwiseInverse().asDiagonal() * share * root.cwiseInverse().asDiagonal();
    }
    even_.push_back(medium_.albedo * (steep.asDiagonal() * even * steep.asDiagonal()));
    odd_.push_back(medium_.albedo * (steep.asDiagonal() * odd * steep.asDiagonal()));
  }
}

LateralMedium::Transfer LateralMedium::transfer(double q, const LateralRows& rows) const {
  const Index live = directions_.live;
  const AzimuthRule& nodes = rows.azimuths;
  const AzimuthRule& beam = rows.beam_azimuths;
  const Index first = live * nodes.count;
  const Index size = first + beam.count;
  const VectorXd steep = directions_.mu.cwiseInverse();
  const VectorXd slant = (q / extinction_) * sine_.cwiseProduct(steep);
  MatrixXd streaming = MatrixXd::Zero(size, size);
  for (Index j = 0; j < nodes.count; ++j) {
    for (Index k = 0; k < nodes.count; ++k) {
      if (nodes.wave(j, k) != 0.0) {
        streaming.block(j * live, k * live, live, live).diagonal() = nodes.wave(j, k) * slant.head(live);
      }
    }
    streaming.block(j * live, j * live, live, live).diagonal() += steep.head(live);
  }
  streaming.bottomRightCorner(beam.count, beam.count) = slant[live] * beam.wave;
  streaming.bottomRightCorner(beam.count, beam.count).diagonal().array() += steep[live];
  const auto less_scattering = [&](const std::vector<MatrixXd>& orders) {
    MatrixXd matrix = streaming;
    const Index count = std::min<Index>(nodes.orders(), static_cast<Index>(orders.size()));
    for (Index m = 0; m < count; ++m) {
      const MatrixXd& order = orders[static_cast<std::size_t>(m)];
      for (Index to = 0; to < nodes.count; ++to) {
        for (Index from = 0; from < nodes.count; ++from) {
          matrix.block(to * live, from * live, live, live) -=
              nodes.from_orders(to, m) * nodes.to_orders(m, from) * order.topLeftCorner(live, live);
        }
        for (Index from = 0; m < beam.orders() && from < beam.count; ++from) {
          matrix.block(to * live, first + from, live, 1) -=
              nodes.from_orders(to, m) * beam.to_orders(m, from) * order.block(0, live, live, 1);
        }
      }
    }
    return matrix;
  };
  return {less_scattering(odd_), less_scattering(even_)};
}

/// The share of unscattered light at the cosine `mu` that passes, with the phase of the wave; `cosine` of the azimuth.
std::complex<double> LateralMedium::passed(double q, double mu, std::complex<double> cosine) const {
  const double aside = thickness_ * std::sqrt(std::max(0.0, 1.0 - mu * mu)) / mu;
  return std::exp(-medium_.tau / mu - std::complex<double>(0.0, q * aside) * cosine);
}

/// Transmission without scattering: a complex attenuation for each direction and pair of azimuths.
MatrixXd LateralMedium::passing(double q, const LateralRows& rows) const {
  const Index live = directions_.live;
  const Index first = live * rows.azimuths.count;
  MatrixXd matrix = MatrixXd::Zero(first + rows.beam_azimuths.count, first + rows.beam_azimuths.count);
  const auto fill = [&](const AzimuthRule& azimuths, Index direction, Index row, Index stride) {
    if (azimuths.count == 1) {
      matrix(row, row) = std::exp(-medium_.tau / directions_.mu[direction]);
      return;
    }
    const Index pairs = azimuths.count / 2;
    for (Index j = 0; j < pairs; ++j) {
      const std::complex<double> kept = passed(q, directions_.mu[direction], azimuths.cosines[j]);
      const Index real = row + j * stride;
      const Index imaginary = row + (pairs + j) * stride;
      matrix(real, real) = matrix(imaginary, imaginary) = kept.real();
      matrix(imaginary, real) = kept.imag();
      matrix(real, imaginary) = -kept.imag();
    }
  };
  for (Index i = 0; i < live; ++i) {
    fill(rows.azimuths, i, i, live);
  }
  fill(rows.beam_azimuths, live, first, 1);
  return matrix;
}

void LateralMedium::resolve_passing(VectorXd mu, MatrixXd carry) {
  fine_mu_ = std::move(mu);
  carry_ = std::move(carry);
}

/// Replaces the wave at the nodes, in the unscattered transmission, by its projection on the polynomials of the nodes.
/// Without a wave the nodes are left as they are.
void LateralMedium::add_unresolved(double q, const AzimuthRule& azimuths, MatrixXd& transmit) const {
  if (fine_mu_.size() == 0 || azimuths.count == 1 || std::isinf(thickness_)) {
    return;
  }
  const Index live = directions_.live;
  const Index pairs = azimuths.count / 2;
  const auto by_wave = [&](double mu, Index pair) {
    return passed(q, mu, azimuths.cosines[pair]) - std::exp(-medium_.tau / mu);
  };
  VectorXd real(fine_mu_.size());
  VectorXd imaginary(fine_mu_.size());
  for (Index j = 0; j < pairs; ++j) {
    for (Index k = 0; k < fine_mu_.size(); ++k) {
      const std::complex<double> one = by_wave(fine_mu_[k], j);
      real[k] = one.real();
      imaginary[k] = one.imag();
    }
    MatrixXd even = carry_.transpose() * real.asDiagonal() * carry_;
    MatrixXd odd = carry_.transpose() * imaginary.asDiagonal() * carry_;
    for (Index i = 0; i < live; ++i) {
      const std::complex<double> one = by_wave(directions_.mu[i], j);
      even(i, i) -= one.real();
      odd(i, i) -= one.imag();
    }
    const Index other = (pairs + j) * live;
    transmit.block(j * live, j * live, live, live) += even;
    transmit.block(other, other, live, live) += even;
    transmit.block(other, j * live, live, live) += odd;
    transmit.block(j * live, other, live, live) -= odd;
  }
}

MatrixXd LateralMedium::spread(const MatrixXd& compact, const LateralRows& rows) const {
  const Index live = directions_.live;
  if (live == rows.nodes) {
    return compact;
  }
  const Index azimuths = rows.azimuths.count;
  const Index beam = rows.beam_azimuths.count;
  MatrixXd all = MatrixXd::Zero(rows.size(), rows.size());
  for (Index j = 0; j < azimuths; ++j) {
    for (Index k = 0; k < azimuths; ++k) {
      all.block(j * rows.nodes, k * rows.nodes, live, live) = compact.block(j * live, k * live, live, live);
    }
    all.block(j * rows.nodes, rows.beam(), live, beam) = compact.block(j * live, azimuths * live, live, beam);
  }
  all.bottomRightCorner(beam, beam) = compact.bottomRightCorner(beam, beam);
  return all;
}

LateralFunction LateralMedium::at(double q, const LateralRows& rows) const {
  const Index size = rows.size();
  if (!scatters_) {
    if (std::isinf(thickness_)) {
      const MatrixXd none = MatrixXd::Zero(size, size);
      return {none, none, none, none};
    }
    MatrixXd direct = passing(q, rows);
    add_unresolved(q, rows.azimuths, direct);
    const MatrixXd through = spread(direct, rows);
    return {MatrixXd::Zero(size, size), through, MatrixXd::Zero(size, size), through};
  }
  const Transfer m = transfer(q, rows);
  // Double a half-space until nothing is transmitted. Without absorption, rounding errors of the slowest rate limit the
  // thickness.
  constexpr double kEndless = 1e8;
  const double tau = std::min(medium_.tau, kEndless);
  const double steepest = std::hypot(1.0, q / extinction_) / directions_.mu.head(directions_.live).minCoeff();
  const int doublings = std::max(0, static_cast<int>(std::ceil(std::log2(0.5 * tau * steepest / kThin))));
  HalfLayer half = thin_layer(m.a, m.b, 0.5 * std::ldexp(tau, -doublings));
  for (int k = 0; k < doublings; ++k) {
    if (!redouble(half)) {
      break;
    }
  }
  LayerPair layer = whole_layer(half);
  add_unresolved(q, rows.azimuths, layer.transmit);
  const MatrixXd reflect = spread(layer.reflect, rows);
  const MatrixXd through = std::isinf(thickness_) ? MatrixXd::Zero(size, size) : spread(layer.transmit, rows);
  return {reflect, through, reflect, through};
}

LateralFunction LateralMedium::at_infinity(const LateralRows& rows) const {
  const Index size = rows.size();
  LateralFunction none{MatrixXd::Zero(size, size), MatrixXd::Zero(size, size), MatrixXd::Zero(size, size),
                       MatrixXd::Zero(size, size)};
  if (rows.beam_azimuths.count == 1) {
    // All scattered light, including the truncated peak, leaves beside the beam.
    none.down(rows.beam(), rows.beam()) = none.up(rows.beam(), rows.beam()) = std::exp(-whole_tau_);
  }
  return none;
}

}  // namespace lamina
