// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/angle_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

using Eigen::Index;
using std::numbers::pi;

constexpr Index kStencil = 6;
constexpr double kSteps = static_cast<double>(AngleTable::kKnots - 1);

struct Stencil {
  Index first;
  std::array<double, kStencil> weights;

  explicit Stencil(double mu) : weights{} {
    const double x = std::acos(std::min(mu, 1.0)) / (0.5 * pi) * kSteps;
    first = std::clamp<Index>(static_cast<Index>(x) - kStencil / 2 + 1, 0, AngleTable::kKnots - kStencil);
    for (std::size_t a = 0; a < kStencil; ++a) {
      double weight = 1.0;
      for (std::size_t b = 0; b < kStencil; ++b) {
        if (b != a) {
          weight *= (x - static_cast<double>(first) - static_cast<double>(b)) /
                    (static_cast<double>(a) - static_cast<double>(b));
        }
      }
      weights[a] = weight;
    }
  }
};

}  // namespace

Eigen::VectorXd AngleTable::cosines() {
  Eigen::VectorXd mu(kKnots);
  for (Index k = 0; k < kKnots; ++k) {
    mu[k] = std::max(1e-6, std::cos(0.5 * pi * static_cast<double>(k) / kSteps));
  }
  return mu;
}

AngleTable::AngleTable(const std::vector<Eigen::MatrixXd>& orders, bool meets)
    : values_(static_cast<Index>(orders.size()), kKnots * kKnots), meets_(meets) {
  for (std::size_t m = 0; m < orders.size(); ++m) {
    values_.row(static_cast<Index>(m)) = orders[m].reshaped().transpose().array().cast<float>();
  }
}

Eigen::ArrayXd AngleTable::at(double mu_o, double mu_i) const {
  const Stencil rows(mu_o);
  const Stencil columns(mu_i);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(values_.rows());
  for (std::size_t b = 0; b < columns.weights.size(); ++b) {
    const Index column = columns.first + static_cast<Index>(b);
    for (std::size_t a = 0; a < rows.weights.size(); ++a) {
      sum += columns.weights[b] * rows.weights[a] *
             values_.col(column * kKnots + rows.first + static_cast<Index>(a)).cast<double>();
    }
  }
  return sum;
}

}  // namespace lamina
