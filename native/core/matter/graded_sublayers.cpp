// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/graded_sublayers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "phase/phase_blend.hpp"

namespace lamina {
namespace {

/// Distance from a face below which intervals no longer get shorter.
constexpr double kFace = 0.05;

/// Numbers the intervals from the top: their length is `coarseness` times the distance from the nearer face.
class Intervals {
 public:
  Intervals(double tau, double coarseness) : tau_(tau), coarseness_(coarseness) {}

  double count(double depth) const {
    const double half = std::log1p(0.5 * tau_ / kFace);
    const double upper = std::log1p(std::min(depth, tau_ - depth) / kFace);
    return (depth <= 0.5 * tau_ ? upper : 2.0 * half - upper) / coarseness_;
  }
  double depth(double count) const {
    const double half = std::log1p(0.5 * tau_ / kFace);
    const double passed = count * coarseness_;
    return passed <= half ? kFace * std::expm1(passed) : tau_ - kFace * std::expm1(2.0 * half - passed);
  }

 private:
  double tau_;
  double coarseness_;
};

/// The contribution of a phase function to an interval: the mean of its albedo, and the first moment about the middle.
struct Share {
  double mean = 0.0;
  double moment = 0.0;
  const PhaseFunction* phase = nullptr;
};

std::vector<Share> shares_in(const GradedMedium& medium, double top, double bottom) {
  std::vector<Share> shares;
  const auto add = [&](double mean, double moment, const PhaseFunction& phase) {
    const auto known =
        std::find_if(shares.begin(), shares.end(), [&](const Share& share) { return alike(*share.phase, phase); });
    if (known == shares.end()) {
      shares.push_back({mean, moment, &phase});
    } else {
      known->mean += mean;
      known->moment += moment;
    }
  };
  const auto& knots = medium.knots();
  const double whole = bottom - top;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const double from = std::max(top, knots[k].tau);
    const double to = std::min(bottom, knots[k + 1].tau);
    if (!(to > from)) {
      continue;
    }
    // Gauss quadrature with two points is exact for products of two linear functions.
    for (const double place : {-1.0, 1.0}) {
      const double depth = 0.5 * (from + to + place / std::sqrt(3.0) * (to - from));
      const double weight = 0.5 * (to - from) / whole;
      const double lower = (depth - knots[k].tau) / (knots[k + 1].tau - knots[k].tau);
      const double x = (depth - top) / whole - 0.5;
      const double a = weight * (1.0 - lower) * knots[k].albedo;
      const double b = weight * lower * knots[k + 1].albedo;
      add(a, a * x, knots[k].phase);
      add(b, b * x, knots[k + 1].phase);
    }
  }
  return shares;
}

Medium sublayer_from(const std::vector<Share>& shares, double moment, double tau) {
  double albedo = 0.0;
  std::vector<std::pair<double, const PhaseFunction*>> weighted;
  for (const Share& share : shares) {
    const double weight = std::max(0.0, share.mean + moment * share.moment);
    albedo += weight;
    weighted.emplace_back(weight, share.phase);
  }
  if (albedo == 0.0) {
    return {0.0, tau, PhaseFunction()};
  }
  return {std::min(1.0, albedo), tau, blend(weighted)};
}

/// Adds the two halves of an interval. The moment is reduced where the profile bends so strongly that a half would get
/// a negative albedo, or one above 1.
void add_interval(const GradedMedium& medium, double top, double bottom, std::vector<Medium>& sublayers) {
  constexpr double kFromMoment = 4.0;  // a linear function of moment M is mean -+ 4 M at 1/6 and 5/6 of the interval
  const std::vector<Share> shares = shares_in(medium, top, bottom);
  double factor = kFromMoment;
  double mean = 0.0;
  double moment = 0.0;
  for (const Share& share : shares) {
    if (factor * std::abs(share.moment) > share.mean) {
      factor = share.mean / std::abs(share.moment);
    }
    mean += share.mean;
    moment += share.moment;
  }
  if (mean + factor * std::abs(moment) > 1.0 && moment != 0.0) {
    factor = std::max(0.0, (1.0 - mean) / std::abs(moment));
  }
  const double half = 0.5 * (bottom - top);
  sublayers.push_back(sublayer_from(shares, -factor, half));
  sublayers.push_back(sublayer_from(shares, factor, half));
}

}  // namespace

std::vector<Medium> sublayers_of(const GradedMedium& medium, double coarseness) {
  const auto& knots = medium.knots();
  const Intervals intervals(medium.tau(), coarseness);
  std::vector<Medium> sublayers;
  std::size_t first = 0;
  while (first + 1 < knots.size()) {
    // Joins varying pieces up to a jump, or up to a bend between two long pieces.
    const auto length = [&](std::size_t piece) {
      return intervals.count(knots[piece + 1].tau) - intervals.count(knots[piece].tau);
    };
    constexpr double kLong = 0.5;  // of an interval
    std::size_t last = first + 1;
    while (last + 1 < knots.size() && knots[last + 1].tau > knots[last].tau && !medium.is_constant(last - 1) &&
           !medium.is_constant(last) && std::min(length(last - 1), length(last)) < kLong) {
      ++last;
    }
    const double top = knots[first].tau;
    const double bottom = knots[last].tau;
    if (medium.is_constant(first) && last == first + 1 && bottom > top) {
      sublayers.push_back({knots[first].albedo, bottom - top, knots[first].phase});
    } else if (bottom > top) {
      const double begin = intervals.count(top);
      const double end = intervals.count(bottom);
      const double steps = std::max(1.0, std::ceil(end - begin - 1e-9));
      double upper = top;
      for (double k = 1.0; k <= steps; ++k) {
        const double lower = k == steps ? bottom : intervals.depth(begin + (end - begin) * k / steps);
        add_interval(medium, upper, lower, sublayers);
        upper = lower;
      }
    }
    first = last;
  }
  return sublayers;
}

}  // namespace lamina
