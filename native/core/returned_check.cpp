// SPDX-License-Identifier: GPL-3.0-or-later
#include "returned_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "evaluation.hpp"
#include "facet_meetings.hpp"
#include "once_scattered.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using std::numbers::pi;

/// What a smaller value counts as: of the mean over azimuths, and in 1/sr.
constexpr double kFaint = 1e-3;
constexpr double kLeast = 1e-3;

/// Sum of the orders that follow these, of geometric decay: the last four against the four before.
double rest_of(const ArrayXd& orders) {
  constexpr Index kFew = 4;
  constexpr double kSlowest = 0.9;
  const Index few = std::min(kFew, orders.size() / 2);
  const double last = orders.tail(few).abs().sum();
  const double before = orders.segment(orders.size() - 2 * few, few).abs().sum();
  const double ratio = last < kSlowest * before ? last / before : kSlowest;
  return last * ratio / (1.0 - ratio);
}

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
  const std::vector<std::vector<Eigen::MatrixXd>> smooth = smooth_orders(assembly, meetings, passages, pool);
  SolveChecks checks;
  for (std::size_t k = 0; k < passages.size(); ++k) {
    const auto& [side, path] = passages[k];
    const OnceScattered once(assembly, side, path);
    for (Index o = 0; o < mu.size(); ++o) {
      for (Index i = path == Path::kReflect ? o : 0; i < mu.size(); ++i) {
        ArrayXd orders(solution.orders());
        ArrayXd values = once(o, i, dphi.cos()) + meetings.value(side, path, o, i, dphi);
        for (Index m = 0; m < orders.size(); ++m) {
          orders[m] = (m == 0 ? 1.0 : 2.0) / pi * smooth[k][static_cast<std::size_t>(m)](o, i);
          values += orders[m] * (static_cast<double>(m) * dphi).cos();
        }
        const double mean = 0.5 / pi * ((values.head(dphi.size() - 1) + values.tail(dphi.size() - 1)) *
                                        (dphi.tail(dphi.size() - 1) - dphi.head(dphi.size() - 1)))
                                           .sum();
        const double scale = std::max(values.minCoeff(), kFaint * mean);
        SolveChecks found;
        found.azimuth = rest_of(orders) / std::max(scale, kLeast);
        found.negativity = std::max(0.0, -values.minCoeff()) / std::max(mean, kLeast);
        checks.worsen(found);
      }
    }
  }
  return checks;
}

}  // namespace lamina
