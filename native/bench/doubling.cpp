// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the doubling step (a layer joined with itself) against this machine's rate of matrix products, alternating
// in the same run. Prints one line of JSON per size.
//     bench_doubling [ROUNDS]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "operators/adding.hpp"
#include "solve/homogeneous_layer.hpp"

namespace {

using namespace lamina;

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Floating-point operations of join() without targets: 2 n^3 per product, 2/3 n^3 for LU, 2 n^3 to solve with it.
double join_operations(double n) { return (8 * 2.0 + 2.0 / 3.0) * n * n * n; }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int count, char** words) {
  constexpr int kGemm = 512;
  const int rounds = count > 1 ? std::atoi(words[1]) : 15;
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(kGemm, kGemm);
  const Eigen::MatrixXd b = Eigen::MatrixXd::Random(kGemm, kGemm);
  Eigen::MatrixXd c(kGemm, kGemm);
  for (const int nodes : {32, 64, 128}) {
    const Directions directions = DirectionSet({1.0}, nodes, {}).in_medium(1.0, Eigen::VectorXd());
    const TruncatedMedium medium(Medium{0.9, 1.0, PhaseFunction(HenyeyGreenstein{0.75})}, 2 * nodes);
    const HomogeneousModes::Layer solved = HomogeneousModes(medium, 0, directions).layer(medium.tau);
    ScatteringFunction layer = ScatteringFunction::empty(directions);
    layer.reflect_above.kernel = layer.reflect_below.kernel = solved.reflect;
    layer.transmit.kernel = solved.transmit;
    layer.transmit.delta.setZero();
    const int repeats = std::max(4, 2000000 / (nodes * nodes * nodes));
    std::vector<double> join_rates;
    std::vector<double> gemm_rates;
    double sink = 0.0;
    for (int round = 0; round < rounds; ++round) {
      const double joined = seconds_of([&] {
        for (int k = 0; k < repeats; ++k) {
          sink += join(layer, layer).reflect_above.kernel(0, 0);
        }
      });
      const double multiplied = seconds_of([&] { c.noalias() = a * b; });
      join_rates.push_back(join_operations(nodes) * repeats / joined);
      gemm_rates.push_back(2.0 * kGemm * kGemm * kGemm / multiplied);
    }
    const double join_rate = median(join_rates);
    const double gemm_rate = median(gemm_rates);
    std::printf("{\"nodes\": %d, \"join_gflops\": %.2f, \"dgemm_gflops\": %.2f, \"share\": %.3f, \"join_us\": %.1f}\n",
                nodes, join_rate * 1e-9, gemm_rate * 1e-9, join_rate / gemm_rate,
                join_operations(nodes) / join_rate * 1e6);
    if (sink + c(0, 0) == 0.123) {
      std::puts("");
    }
  }
}
