// SPDX-License-Identifier: GPL-3.0-or-later
#include "maps/window.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <vector>

namespace lamina {

namespace {

constexpr std::size_t kBlock = 512;                  // points of a task
constexpr std::size_t kMostTerms = 3 + kMostGuides;  // a constant, the place, the guides

/// Calls task(point) for all points.
template <typename Task>
void for_each_point(std::size_t points, ThreadPool& pool, const Task& task) {
  pool.run((points + kBlock - 1) / kBlock, [&](std::size_t block) {
    const std::size_t end = std::min(points, (block + 1) * kBlock);
    for (std::size_t point = block * kBlock; point < end; ++point) {
      task(point);
    }
  });
}

/// Calls take(the neighbour's number, its weight, its place) for each neighbour of a point.
template <typename Take>
void for_each_neighbour(const Window& window, std::size_t point, const Take& take) {
  for (std::size_t k = 0; k < window.neighbours; ++k) {
    const std::size_t here = k * window.points + point;
    const std::int32_t number = window.numbers[here];
    const std::size_t at = window.is_uniform ? k : here;
    if (number >= 0 && window.weights[at] > 0.0F) {
      take(static_cast<std::size_t>(number), static_cast<double>(window.weights[at]), window.places + 2 * at);
    }
  }
}

}  // namespace

void window_mean(const Window& window, const PointValues& values, double* found, ThreadPool& pool) {
  for_each_point(window.points, pool, [&](std::size_t point) {
    double* const out = found + point * values.columns;
    std::fill_n(out, values.columns, 0.0);
    double total = 0.0;
    for_each_neighbour(window, point, [&](std::size_t other, double weight, const float*) {
      const double* const own = values.data + other * values.columns;
      for (std::size_t column = 0; column < values.columns; ++column) {
        out[column] += weight * own[column];
      }
      total += weight;
    });
    for (std::size_t column = 0; column < values.columns; ++column) {
      out[column] /= total;
    }
  });
}

void window_regression(const Window& window, const PointValues& guides, const PointValues& values, double ridge,
                       double* fit, double* leverage, ThreadPool& pool) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostTerms, kMostTerms>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostTerms, 1>;
  const std::size_t terms = 3 + guides.columns;
  const auto size = static_cast<Eigen::Index>(terms);
  for_each_point(window.points, pool, [&](std::size_t point) {
    Matrix matrix = Matrix::Zero(size, size);
    std::vector<double> right(terms * values.columns, 0.0);
    std::array<double, kMostTerms> row{1.0};
    const double* const here = guides.data + point * guides.columns;
    for_each_neighbour(window, point, [&](std::size_t other, double weight, const float* place) {
      row[1] = static_cast<double>(place[0]);
      row[2] = static_cast<double>(place[1]);
      for (std::size_t guide = 0; guide < guides.columns; ++guide) {
        row[3 + guide] = guides.data[other * guides.columns + guide] - here[guide];
      }
      const double* const own = values.data + other * values.columns;
      for (std::size_t term = 0; term < terms; ++term) {
        const double weighted = weight * row[term];
        for (std::size_t with = 0; with <= term; ++with) {
          matrix(static_cast<Eigen::Index>(term), static_cast<Eigen::Index>(with)) += weighted * row[with];
        }
        for (std::size_t column = 0; column < values.columns; ++column) {
          right[term * values.columns + column] += weighted * own[column];
        }
      }
    });
    matrix.diagonal().tail(size - 1).array() += ridge * matrix(0, 0);
    // The fit at the point is the constant term: the first row of the inverse times the right side.
    const Vector first = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(Vector::Unit(size, 0));
    leverage[point] = first[0];
    double* const out = fit + point * values.columns;
    std::fill_n(out, values.columns, 0.0);
    for (std::size_t term = 0; term < terms; ++term) {
      for (std::size_t column = 0; column < values.columns; ++column) {
        out[column] += first[static_cast<Eigen::Index>(term)] * right[term * values.columns + column];
      }
    }
  });
}

}  // namespace lamina
