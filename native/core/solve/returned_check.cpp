// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/returned_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "solve/evaluation.hpp"
#include "solve/facet_meetings.hpp"
#include "solve/rays_between_lobes.hpp"
#include "solve/scattering_between_lobes.hpp"
#include "solve/stack_single_scattering.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using std::numbers::pi;

/// Errors are relative to the value, but at least to this share of the mean over azimuths and to this value in 1/sr.
constexpr double kFaint = 1e-3;
constexpr double kLeast = 1e-3;

/// Bounds the contribution of the truncated orders at these azimuths. Orders are assumed to decay geometrically, at the
/// ratio of the last four to the four before. If their signs are all equal, or alternate, the cosines cancel except
/// near azimuth 0, or pi, and summation by parts gives a smaller bound.
ArrayXd rest_of(const ArrayXd& orders, const ArrayXd& dphi) {
  constexpr Index kFew = 4;
  const double slowest = std::pow(kSlowestDecay, kFew);
  const Index few = std::min(kFew, orders.size() / 2);
  const ArrayXd tail = orders.tail(few);
  const double last = tail.abs().sum();
  const double before = orders.segment(orders.size() - 2 * few, few).abs().sum();
  const double ratio = last < slowest * before ? last / before : slowest;
  const double all = last * ratio / (1.0 - ratio);
  const ArrayXd steps = tail.head(few - 1) * tail.tail(few - 1);
  ArrayXd rest = ArrayXd::Constant(dphi.size(), all);
  if ((steps > 0.0).all() || (steps < 0.0).all()) {
    const ArrayXd half = 0.5 * dphi;
    const ArrayXd distance = (steps > 0.0).all() ? half.sin().eval() : half.cos().eval();
    rest = rest.min(tail.abs().maxCoeff() / (2.0 * distance.max(1e-9)));
  }
  return rest;
}

/// The sum of azimuth orders of pi f between two targets, in 1/sr.
ArrayXd sum_of(const std::vector<Eigen::MatrixXd>& orders, Index o, Index i, const ArrayXd& dphi) {
  ArrayXd sum = ArrayXd::Zero(dphi.size());
  for (std::size_t m = 0; m < orders.size(); ++m) {
    sum += (m == 0 ? 1.0 : 2.0) / pi * orders[m](o, i) * (static_cast<double>(m) * dphi).cos();
  }
  return sum;
}

/// The last azimuths of the check, at which single scattering is compared with a sum over rays.
constexpr Index kBack = 2;

}  // namespace

SolveChecks check_returned(const Solution& solution, ThreadPool& pool) {
  const Eigen::VectorXd mu{{0.06, 0.3, 0.6, 0.9}};
  const ArrayXd dphi{{0.0, 0.2, 0.6, 1.2, 1.8, 2.5, pi}};
  const Assembly assembly(solution, mu, pool);
  const FacetMeetings meetings(assembly);
  std::vector<Passage> passages{{Side::kTop, Path::kReflect}};
  if (solution.stack().base.kind == Base::Kind::kNone) {
    passages.push_back({Side::kBottom, Path::kReflect});
    passages.push_back({Side::kTop, Path::kTransmit});
  }
  const ScatteringBetweenLobes between(assembly, pool, true);
  const RaysBetweenLobes rays(assembly);
  const std::vector<std::vector<Eigen::MatrixXd>> smooth = smooth_orders(assembly, meetings, between, passages, pool);
  const std::vector<Eigen::MatrixXd> held = between.none() ? std::vector<Eigen::MatrixXd>() : between.held();
  SolveChecks checks;
  for (std::size_t k = 0; k < passages.size(); ++k) {
    const auto& [side, path] = passages[k];
    const StackSingleScattering once(assembly, side, path);
    for (Index o = 0; o < mu.size(); ++o) {
      for (Index i = path == Path::kReflect ? o : 0; i < mu.size(); ++i) {
        ArrayXd orders(between.orders());
        ArrayXd values = once(o, i, dphi.cos()) + meetings.value(side, path, o, i, dphi);
        for (Index m = 0; m < orders.size(); ++m) {
          orders[m] = (m == 0 ? 1.0 : 2.0) / pi * smooth[k][static_cast<std::size_t>(m)](o, i);
          values += orders[m] * (static_cast<double>(m) * dphi).cos();
        }
        const double mean = 0.5 / pi *
                            ((values.head(dphi.size() - 1) + values.tail(dphi.size() - 1)) *
                             (dphi.tail(dphi.size() - 1) - dphi.head(dphi.size() - 1)))
                                .sum();
        SolveChecks found;
        found.azimuth = (rest_of(orders, dphi) / values.max(std::max(kFaint * mean, kLeast))).maxCoeff();
        found.negativity = std::max(0.0, -values.minCoeff()) / std::max(mean, kLeast);
        if (k == 0 && o == i && o > 1 && !between.none()) {
          const ArrayXd kept = sum_of(held, o, i, dphi.tail(kBack));
          const ArrayXd scale = values.tail(kBack).max(std::max(kFaint * mean, kLeast));
          const auto lost = [&](bool precise) {
            return ((rays.value(o, i, dphi.tail(kBack), precise) - kept).abs() / scale).maxCoeff();
          };
          found.resolution = lost(false);
          if (!(found.resolution < solution.resolution().tolerance)) {
            found.resolution = lost(true);  // few rays may miss the peak of a phase function
          }
        }
        checks.worsen(found);
      }
    }
  }
  return checks;
}

}  // namespace lamina
