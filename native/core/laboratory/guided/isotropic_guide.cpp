// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/isotropic_guide.hpp"

#include <algorithm>
#include <cmath>

#include "guided/reflection_by_height.hpp"

namespace lamina {
namespace {

constexpr int kNodes = 16;  // coarse: the guide needs a few digits only
/// Share of a cosine-weighted density in the tables' densities, so that every direction is possible.
constexpr double kPlain = 0.005;

}  // namespace

IsotropicGuide::Place IsotropicGuide::place(double mu) {
  const double x = std::sqrt(mu) * static_cast<double>(kCells);
  const std::size_t cell = std::min(static_cast<std::size_t>(x), kCells - 1);
  return {cell, x - static_cast<double>(cell)};
}

IsotropicGuide::IsotropicGuide(const GradedMedium& medium) : heights_(medium) {
  const std::size_t heights = heights_.size();
  Eigen::VectorXd mu(kPoints);
  Eigen::VectorXd root(kPoints);
  for (std::size_t k = 0; k < kPoints; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(kCells);
    root[static_cast<Eigen::Index>(k)] = x;
    mu[static_cast<Eigen::Index>(k)] = std::max(1e-8, x * x);
  }

  // Solve the slab below each height
  const ReflectionByHeight reflection(medium, heights_.above_zero(), kNodes, mu);
  const std::vector<Eigen::MatrixXd> s = reflection.order(0);
  const Directions& directions = reflection.directions();
  const Eigen::Index nodes = directions.nodes;
  const Eigen::RowVectorXd share = 0.5 * directions.weight.cwiseQuotient(directions.mu.head(nodes)).transpose();

  escape_.assign(kPoints, GuideHeights::Column::Ones());
  for (std::size_t j = 0; j < heights; ++j) {
    albedo_[static_cast<Eigen::Index>(j)] = static_cast<float>(medium.at(heights_[j]).albedo());
  }
  density_.resize(heights * kPoints * kPoints);
  cumulative_.resize(density_.size());

  // Tabulate X and the density of mu' above height 0
  for (std::size_t j = 1; j < heights; ++j) {
    const Eigen::RowVectorXd scattered = share * s[j - 1].topRightCorner(nodes, kPoints);
    for (std::size_t point = 0; point < kPoints; ++point) {
      const auto column = nodes + static_cast<Eigen::Index>(point);
      escape_[point][static_cast<Eigen::Index>(j)] =
          static_cast<float>(1.0 + scattered[static_cast<Eigen::Index>(point)]);
      double* density = &density_[(j * kPoints + point) * kPoints];
      double* sum = &cumulative_[(j * kPoints + point) * kPoints];
      double whole = 0.0;
      for (std::size_t k = 0; k < kPoints; ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        density[k] = std::max(0.0, s[j - 1](nodes + i, column) / mu[i] * root[i]);
        if (k > 0) {
          whole += 0.5 * (density[k] + density[k - 1]) / static_cast<double>(kCells);
        }
      }
      sum[0] = 0.0;
      for (std::size_t k = 0; k < kPoints; ++k) {
        const double x = static_cast<double>(k) / static_cast<double>(kCells);
        density[k] = whole > 0.0 ? (1.0 - kPlain) * density[k] / whole + kPlain * 2.0 * x : 2.0 * x;
        if (k > 0) {
          sum[k] = sum[k - 1] + 0.5 * (density[k] + density[k - 1]) / static_cast<double>(kCells);
        }
      }
    }
  }

  // Tabulate them at height 0, where S / mu' = 4 mu rho is that of the surface
  for (std::size_t point = 0; point < kPoints; ++point) {
    escape_[point][0] = static_cast<float>(1.0 + 2.0 * medium.ground() * mu[static_cast<Eigen::Index>(point)]);
  }
  if (medium.ground() > 0.0) {
    for (std::size_t point = 0; point < kPoints; ++point) {
      for (std::size_t k = 0; k < kPoints; ++k) {
        const double x = static_cast<double>(k) / static_cast<double>(kCells);
        density_[point * kPoints + k] = 2.0 * x;
        cumulative_[point * kPoints + k] = x * x;
      }
    }
    return;
  }

  // Copy the densities of the next height, since S is 0 at height 0 without a surface
  std::copy_n(density_.begin() + kPoints * kPoints, kPoints * kPoints, density_.begin());
  std::copy_n(cumulative_.begin() + kPoints * kPoints, kPoints * kPoints, cumulative_.begin());
}

IsotropicGuide::Direction IsotropicGuide::draw(std::size_t j, double up, const Place& place, Rng& rng) const {
  // Draw one of the four neighbouring tables, then a cosine from its density
  const std::size_t height = j + (rng.uniform() < up ? 1 : 0);
  const std::size_t point = place.cell + (rng.uniform() < place.fraction ? 1 : 0);
  const double* sum = cumulative(height, point);
  const double* own = row(height, point);
  const double u = rng.uniform() * sum[kCells];
  const std::size_t cell =
      std::min(static_cast<std::size_t>(std::upper_bound(sum + 1, sum + kCells, u) - sum) - 1, kCells - 1);
  // Invert the quadratic integral of the linear density, by the root without cancellation
  const double a = own[cell];
  const double b = own[cell + 1];
  const double area = (u - sum[cell]) * static_cast<double>(kCells);
  const double x = std::min(1.0, 2.0 * area / (a + std::sqrt(std::max(0.0, a * a + 2.0 * (b - a) * area))));
  const double root = (static_cast<double>(cell) + x) / static_cast<double>(kCells);

  // Interpolate the densities of the four tables
  const auto at = [&](std::size_t h, std::size_t p) {
    const double* d = row(h, p) + cell;
    return d[0] + x * (d[1] - d[0]);
  };
  const double lower = at(j, place.cell) + place.fraction * (at(j, place.cell + 1) - at(j, place.cell));
  const double upper = at(j + 1, place.cell) + place.fraction * (at(j + 1, place.cell + 1) - at(j + 1, place.cell));
  return {root * root, (lower + up * (upper - lower)) / (2.0 * root)};
}

}  // namespace lamina
