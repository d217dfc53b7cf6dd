// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/fine_quadrature.hpp"

#include <algorithm>

#include "numeric/quadrature.hpp"

namespace lamina {
namespace {

constexpr int kPerPiece = 8;

void add_piece(Nodes& nodes, double low, double high) {
  static const Quadrature rule(kPerPiece);
  for (Eigen::Index i = 0; i < rule.mu.size(); ++i) {
    nodes.place.push_back(low + (high - low) * rule.mu[i]);
    nodes.weight.push_back((high - low) * rule.weight[i]);
  }
}

}  // namespace

Nodes graded(double low, double high, double finest, bool root_at_high) {
  Nodes nodes;
  const double end = root_at_high ? 0.5 * (low + high) : high;
  double from = low;
  double length = std::min(finest, end - low);
  while (from < end) {
    // Extend the last piece if the rest would be short.
    const double to = from + 1.5 * length >= end ? end : from + length;
    add_piece(nodes, from, to);
    from = to;
    length = std::max(length, from - low);
  }
  if (root_at_high) {
    constexpr double kShortest = 1e-5;
    double rest = high - end;
    while (rest > kShortest * (high - low)) {
      add_piece(nodes, high - rest, high - 0.25 * rest);
      rest *= 0.25;
    }
    add_piece(nodes, high - rest, high);
  }
  return nodes;
}

Nodes between_cosines(double critical) {
  constexpr double kShortest = 1e-6;
  Nodes nodes;
  const double middle = 0.5 * (critical + 1.0);
  for (const double end : {critical, 1.0}) {
    double rest = middle - end;  // signed
    while (rest > kShortest || rest < -kShortest) {
      add_piece(nodes, std::min(end + rest, end + 0.25 * rest), std::max(end + rest, end + 0.25 * rest));
      rest *= 0.25;
    }
    add_piece(nodes, std::min(end, end + rest), std::max(end, end + rest));
  }
  return nodes;
}

}  // namespace lamina
