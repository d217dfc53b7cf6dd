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

constexpr int kWidth = 8;              // lines of the grid that a ray touches
constexpr Index kMargin = kWidth / 2;  // lines beyond each end of the grid that rays touch
using KernelWeights = Eigen::Array<double, kWidth, 1>;
constexpr double kSteepness = 2.3 * kWidth;
constexpr Index kFiner = 2;  // lines per wave

/// An even number of lines.
Index lines_for(int waves) { return std::max<Index>(kWidth, kFiner * waves); }

/// cos(j angle) at the lines of a grid, pi (a + 1/2) / lines, divided by the kernel's Fourier coefficient of wave j:
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

/// The values of the kernel on the lines that it touches, as polynomials in the offset of its centre between two lines.
/// Accurate to 1e-8 (Barnett, Magland and af Klinteberg 2019, section 5.3).
class KernelTable {
 public:
  KernelTable() {
    Eigen::Matrix<double, kTerms, kTerms> powers;
    Eigen::Matrix<double, kTerms, kWidth> values;
    for (int row = 0; row < kTerms; ++row) {
      const double at = std::cos(pi * (row + 0.5) / kTerms);
      for (int term = 0; term < kTerms; ++term) {
        powers(row, term) = std::pow(at, term);
      }
      for (int line = 0; line < kWidth; ++line) {
        const double x = (line + 0.5 * (1.0 + at)) / (0.5 * kWidth) - 1.0;
        values(row, line) = std::exp(kSteepness * (std::sqrt(std::max(0.0, 1.0 - x * x)) - 1.0));
      }
    }
    const Eigen::Matrix<double, kTerms, kWidth> solved = powers.partialPivLu().solve(values);
    for (int term = 0; term < kTerms; ++term) {
      terms_[static_cast<std::size_t>(term)] = solved.row(term).transpose().array();
    }
  }

  /// `offset` in [0, 1]: distance from the end of the kernel to the first line.
  KernelWeights operator()(double offset) const {
    const double at = 2.0 * offset - 1.0;
    KernelWeights sum = terms_.back();
    for (std::size_t term = kTerms - 1; term-- > 0;) {
      sum = sum * at + terms_[term];
    }
    return sum;
  }

 private:
  static constexpr int kTerms = 12;
  std::array<KernelWeights, kTerms> terms_;
};

/// The lines near an angle, counted from half a kernel before the first line of the grid, and the kernel there.
struct Spread {
  Index first;
  KernelWeights weight;

  Spread(double cosine, Index lines) {
    static const KernelTable table;
    const double place = std::acos(std::clamp(cosine, -1.0, 1.0)) / pi * static_cast<double>(lines) - 0.5;
    const double begin = std::ceil(place - 0.5 * kWidth);
    first = static_cast<Index>(begin) + kMargin;
    weight = table(begin - place + 0.5 * kWidth);
  }
};

/// Adds the lines beyond the ends of the grid to their mirror images in the grid: waves are even about 0 and about pi.
template <typename Lines>
void fold(Lines lines) {
  const Index count = lines.rows() - 2 * kMargin;
  for (Index a = 0; a < kMargin; ++a) {
    lines.row(kMargin + a) += lines.row(kMargin - 1 - a);
    lines.row(kMargin + count - 1 - a) += lines.row(kMargin + count + a);
  }
}

}  // namespace

WaveTables::WaveTables(const Quadrature& nodes, int orders) : low(nodes.low()), length(nodes.high() - nodes.low()) {
  const auto count = static_cast<int>(nodes.mu.size());
  const Eigen::ArrayXd angle = (2.0 * (nodes.mu.array() - low) / length - 1.0).acos();
  Eigen::MatrixXd waves(count, count);
  for (int j = 0; j < count; ++j) {
    waves.col(j) = (static_cast<double>(j) * angle).cos().matrix();
  }
  // waves^-1 maps the values of a polynomial at the nodes to its waves.
  to_nodes = waves.transpose().partialPivLu().solve(waves_on(lines_for(count), count).transpose());
  const Eigen::MatrixXd half = waves_on(lines_for(orders), orders).topRows(lines_for(orders) / 2);
  to_even_orders = half(Eigen::all, Eigen::seqN(0, (orders + 1) / 2, 2));
  to_odd_orders = half(Eigen::all, Eigen::seqN(1, orders / 2, 2));
}

WaveGrid::WaveGrid(const WaveTables& tables)
    : tables_(tables),
      grid_(Eigen::MatrixXd::Zero(tables.to_nodes.cols() + 2 * kMargin, 2 * (tables.to_even_orders.rows() + kMargin))) {
}

void WaveGrid::add(double share, double mu, double azimuth) {
  const Spread rows(2.0 * (mu - tables_.low) / tables_.length - 1.0, tables_.to_nodes.cols());
  const Spread columns(azimuth, 2 * tables_.to_even_orders.rows());
  double* place = grid_.data() + columns.first * grid_.rows() + rows.first;
  for (int b = 0; b < kWidth; ++b, place += grid_.rows()) {
    Eigen::Map<KernelWeights>{place} += share * columns.weight[b] * rows.weight;
  }
}

Eigen::MatrixXd WaveGrid::sums() const {
  Eigen::MatrixXd grid = grid_;
  fold(grid.topRows(grid.rows()));
  fold(grid.transpose());
  const Index rows = tables_.to_nodes.cols();
  const Index half = tables_.to_even_orders.rows();
  const auto first = grid.block(kMargin, kMargin, rows, half);
  const auto last = grid.block(kMargin, kMargin + half, rows, half).rowwise().reverse();
  const Index even = tables_.to_even_orders.cols();
  const Index odd = tables_.to_odd_orders.cols();
  Eigen::MatrixXd waves(rows, even + odd);
  waves.leftCols(even).noalias() = (first + last).eval() * tables_.to_even_orders;
  waves.rightCols(odd).noalias() = (first - last).eval() * tables_.to_odd_orders;
  Eigen::MatrixXd result(tables_.to_nodes.rows(), even + odd);
  result(Eigen::all, Eigen::seqN(0, even, 2)) = tables_.to_nodes * waves.leftCols(even);
  result(Eigen::all, Eigen::seqN(1, odd, 2)) = tables_.to_nodes * waves.rightCols(odd);
  return result;
}

}  // namespace lamina
