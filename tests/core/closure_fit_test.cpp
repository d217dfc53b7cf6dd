// SPDX-License-Identifier: GPL-3.0-or-later
//
// The closure fit on problems whose answers are known.  Exit status 0 when all hold.
#include "closure_fit.hpp"

#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <vector>

namespace {

using namespace lamina;

int failures = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::printf("FAILED: %s\n", what);
  ++failures;
}

// Karush-Kuhn-Tucker: gradient zero where x > 0, pushing outwards where x = 0.
void nnls_meets_the_optimality_conditions() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 500; ++trial) {
    const int size = 1 + trial % 12;
    Eigen::MatrixXd a(30, size);
    for (auto& value : a.reshaped()) value = std::abs(normal(random));
    a.colwise().normalize();
    Eigen::VectorXd b(30);
    for (auto& value : b) value = normal(random) + 0.5;
    const SmallMatrix gram = a.transpose() * a;
    const SmallVector rhs = a.transpose() * b;
    // A warm start may be anything non-negative.
    SmallVector x = SmallVector::Constant(size, trial % 3 == 0 ? 0.0 : 0.7);
    ActiveSet(gram, rhs).solve(x);
    const Eigen::VectorXd gradient = rhs - gram * x;
    for (int k = 0; k < size; ++k) {
      expect(x[k] >= 0.0, "nnls: x >= 0");
      expect(gradient[k] < 1e-8, "nnls: no descent direction left");
      expect(x[k] == 0.0 || std::abs(gradient[k]) < 1e-8, "nnls: stationary on the passive set");
    }
  }
}

struct Problem {
  std::vector<ColumnGram> grams;
  std::vector<SliceTarget> targets;
  Eigen::VectorXd solid_angle;
  std::vector<Eigen::MatrixXd> values;
};

// Twelve random positive closures in five columns; every slice is closure 2 + 3 * closure 7 + noise.
Problem make_problem(double noise) {
  Problem problem;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  problem.solid_angle = Eigen::VectorXd::Constant(40, 0.1);
  for (int column = 0; column < 5; ++column) {
    Eigen::MatrixXd values(12, 40);
    for (auto& value : values.reshaped()) value = uniform(random);
    problem.grams.push_back(column_gram(values, problem.solid_angle));
    Eigen::VectorXd slice = values.row(2) + 3.0 * values.row(7);
    for (auto& value : slice) value += noise * uniform(random);
    problem.targets.push_back(slice_target(column, problem.grams.back(), values, problem.solid_angle, slice,
                                           slice.dot(problem.solid_angle)));
    problem.values.push_back(values);
  }
  return problem;
}

void a_slice_in_the_span_is_found_exactly() {
  const Problem problem = make_problem(0.0);
  const std::vector<int> chosen{2, 4, 7};
  Eigen::VectorXd weights(3);
  const double error = fit_slice(problem.grams[1], problem.targets[1], chosen, weights);
  expect(error < 1e-6, "fit_slice: error of an exact mixture");
  expect((weights - Eigen::Vector3d(1.0, 0.0, 3.0)).norm() < 1e-6, "fit_slice: weights of an exact mixture");
}

void albedo_is_exact() {
  const Problem problem = make_problem(2.0);
  const std::vector<int> chosen{0, 5, 7};
  for (std::size_t column = 0; column < 5; ++column) {
    Eigen::VectorXd weights(3);
    const double error = fit_slice(problem.grams[column], problem.targets[column], chosen, weights);
    const Eigen::VectorXd albedo = problem.values[column] * problem.solid_angle;
    const double reached = weights[0] * albedo[0] + weights[1] * albedo[5] + weights[2] * albedo[7];
    expect(std::abs(reached / problem.targets[column].albedo - 1.0) < 1e-12, "fit_slice: albedo");
    expect(error > 0.01 && error < 1.0, "fit_slice: error of an inexact mixture");
  }
}

void a_dark_slice_needs_no_light() {
  Problem problem = make_problem(0.0);
  SliceTarget dark = problem.targets[0];
  dark.norm2 = dark.albedo = 0.0;
  dark.rhs.setZero();
  Eigen::VectorXd weights(2);
  const std::vector<int> chosen{1, 2};
  expect(fit_slice(problem.grams[0], dark, chosen, weights) == 0.0, "fit_slice: error of a dark slice");
  expect(weights.isZero(), "fit_slice: weights of a dark slice");
}

void selection_finds_the_closures_and_runs_in_any_order() {
  const Problem problem = make_problem(0.01);
  SelectionOptions options;
  options.closures = 2;
  const Selection found = select_closures(problem.grams, problem.targets, options);
  expect(found.closures == std::vector<int>({2, 7}), "select_closures: the two true closures");
  const ParallelFor backwards = [](int count, const std::function<void(int)>& body) {
    while (count-- > 0) body(count);
  };
  const Selection again = select_closures(problem.grams, problem.targets, options, {}, {}, backwards);
  expect(again.closures == found.closures && again.mean_error == found.mean_error, "select_closures: order of work");
  const std::vector<int> candidates{0, 1, 3, 7};
  const std::vector<int> fixed{3};
  const Selection restricted = select_closures(problem.grams, problem.targets, options, candidates, fixed);
  expect(restricted.closures == std::vector<int>({3, 7}), "select_closures: candidates and fixed closures");
  options.closures = 5;
  options.target_error = 0.01;
  expect(select_closures(problem.grams, problem.targets, options).closures.size() == 2, "select_closures: stops early");
}

}  // namespace

int main() {
  nnls_meets_the_optimality_conditions();
  a_slice_in_the_span_is_found_exactly();
  albedo_is_exact();
  a_dark_slice_needs_no_light();
  selection_finds_the_closures_and_runs_in_any_order();
  if (failures == 0) std::printf("closure fit: all hold\n");
  return failures == 0 ? 0 : 1;
}
