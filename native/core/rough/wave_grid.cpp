// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/wave_grid.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

using Eigen::Index;
using std::numbers::pi;

constexpr int kWidth = 12;  // lines of the grid that a ray touches
constexpr double kSteepness = 2.3 * kWidth;
constexpr double kFiner = 2.0;  // lines for each wave

Index lines_for(int waves) {
  return std::max<Index>(kWidth, static_cast<Index>(std::ceil(kFiner * static_cast<double>(waves))));
}

/// cos(j angle) at the lines of a grid, pi (a + 1/2) / lines, divided by the kernel's own share in that wave:
/// [line, j]. Both the waves and the lines are even about 0 and about pi.
Eigen::MatrixXd waves_on(Index lines, int waves) {
  const Quadrature rule(40);
  const Eigen::ArrayXd kernel = (kSteepness * ((1.0 - rule.mu.array().square()).sqrt() - 1.0)).exp();
  Eigen::MatrixXd table(lines, waves);
  const double step = pi / static_cast<double>(lines);
  for (Index j = 0; j < waves; ++j) {
    const double wave = static_cast<double>(j);
    const double share =
        kWidth * (rule.weight.array() * kernel * (0.5 * kWidth * step * wave * rule.mu.array()).cos()).sum();
    for (Index a = 0; a < lines; ++a) {
      table(a, j) = std::cos(wave * step * (static_cast<double>(a) + 0.5)) / share;
    }
  }
  return table;
}

/// The lines near an angle and the kernel there.
struct Spread {
  std::array<Index, kWidth> line;
  Eigen::Array<double, kWidth, 1> weight;

  Spread(double cosine, Index lines) {
    const double place = std::acos(std::clamp(cosine, -1.0, 1.0)) / pi * static_cast<double>(lines) - 0.5;
    const double first = std::ceil(place - 0.5 * kWidth);
    for (int k = 0; k < kWidth; ++k) {
      const double x = (first + k - place) / (0.5 * kWidth);
      weight[k] = kSteepness * (std::sqrt(std::max(0.0, 1.0 - x * x)) - 1.0);
      const Index a = static_cast<Index>(first) + k;
      line[static_cast<std::size_t>(k)] = a < 0 ? -1 - a : (a >= lines ? 2 * lines - 1 - a : a);
    }
    weight = weight.exp();
  }
};

}  // namespace

WaveTables::WaveTables(const Quadrature& nodes, int orders) : low(nodes.low()), length(nodes.high() - nodes.low()) {
  const auto count = static_cast<int>(nodes.mu.size());
  const Eigen::ArrayXd angle = (2.0 * (nodes.mu.array() - low) / length - 1.0).acos();
  Eigen::MatrixXd waves(count, count);
  for (int j = 0; j < count; ++j) {
    waves.col(j) = (static_cast<double>(j) * angle).cos().matrix();
  }
  // A polynomial's waves from its values at the nodes are waves^-1.
  to_nodes = waves.transpose().partialPivLu().solve(waves_on(lines_for(count), count).transpose());
  to_orders = waves_on(lines_for(orders), orders);
}

WaveGrid::WaveGrid(const WaveTables& tables)
    : tables_(tables), grid_(Eigen::MatrixXd::Zero(tables.to_nodes.cols(), tables.to_orders.rows())) {}

void WaveGrid::add(double share, double mu, double azimuth) {
  const Spread rows(2.0 * (mu - tables_.low) / tables_.length - 1.0, grid_.rows());
  const Spread columns(azimuth, grid_.cols());
  for (int b = 0; b < kWidth; ++b) {
    double* column = grid_.data() + columns.line[static_cast<std::size_t>(b)] * grid_.rows();
    const double weight = share * columns.weight[b];
    for (int a = 0; a < kWidth; ++a) {
      column[rows.line[static_cast<std::size_t>(a)]] += weight * rows.weight[a];
    }
  }
}

Eigen::MatrixXd WaveGrid::sums() const { return tables_.to_nodes * (grid_ * tables_.to_orders); }

}  // namespace lamina
