// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/scattering_ode.hpp"

#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "matter/medium.hpp"
#include "numeric/exponential_steps.hpp"
#include "numeric/quadrature.hpp"
#include "solve/phase_kernel.hpp"

namespace lamina {
namespace {

using Array = ExponentialSteps::Array;

/// The number of azimuth orders that the phase functions need. Throws if the nodes do not resolve a peak.
int needed_orders(const GradedMedium& medium, int nodes) {
  constexpr double kUnresolved = 1e-5;  // largest moment that the nodes may leave unresolved, as in the solver
  constexpr double kUnseen = 1e-11;     // orders with smaller moments are skipped
  int orders = 1;
  for (const GradedMedium::Knot& knot : medium.knots()) {
    const double rest = knot.albedo * std::abs(knot.phase.moment(2 * nodes));
    if (rest > kUnresolved) {
      std::ostringstream message;
      message << "nodes = " << nodes << ": too few for a phase function whose moment " << 2 * nodes << " is " << rest
              << ", must be below " << kUnresolved;
      throw std::invalid_argument(message.str());
    }
    for (int l = orders; l < 2 * nodes; ++l) {
      if (knot.albedo * std::abs(knot.phase.moment(l)) > kUnseen) {
        orders = l + 1;
      }
    }
  }
  return orders;
}

/// One knot's k in one azimuth order, between all directions.
struct Kernel {
  Eigen::MatrixXd back;
  Eigen::MatrixXd on;

  Kernel(const GradedMedium::Knot& knot, int count, int order, const Eigen::VectorXd& mu) {
    TruncatedMedium seen(Medium{knot.albedo, 1.0, PhaseFunction()}, count);
    for (int l = 0; l < count; ++l) {
      seen.moments[static_cast<std::size_t>(l)] = knot.phase.moment(l);
    }
    const PhaseKernel phase(seen, order, mu);
    back = knot.albedo * phase.reflect;
    on = knot.albedo * phase.transmit;
  }
};

/// The equation's terms in one azimuth order.
class Terms {
 public:
  Terms(const GradedMedium& medium, int count, int order, const Eigen::VectorXd& mu, Eigen::VectorXd share)
      : medium_(medium), mu_(mu), share_(std::move(share)) {
    for (const GradedMedium::Knot& knot : medium.knots()) {
      kernels_.emplace_back(knot, count, order, mu);
    }
  }

  /// The right-hand side between the knot `above` and the next one below.
  Array operator()(std::size_t above, double t, const Array& u) const {
    const Eigen::Index all = mu_.size();
    const Eigen::Index n = share_.size();
    const auto& knots = medium_.knots();
    const double depth = medium_.tau() - t;
    const double way = (depth - knots[above].tau) / (knots[above + 1].tau - knots[above].tau);
    const auto mixed = [&](Eigen::MatrixXd Kernel::* part) -> Eigen::MatrixXd {
      return (1.0 - way) * kernels_[above].*part + way * kernels_[above + 1].*part;
    };
    const Eigen::MatrixXd back = mixed(&Kernel::back);
    const Eigen::MatrixXd on = mixed(&Kernel::on);
    const Eigen::MatrixXd s = u.topRows(all).matrix();
    const Eigen::MatrixXd t_below = u.bottomRows(all).matrix();
    const Eigen::MatrixXd shared = share_.asDiagonal() * s.topRows(n);
    // Downward light below the layer at t: scattered forward by it, or reflected by S and then by it.
    const Eigen::MatrixXd down = on + back.leftCols(n) * shared;
    Array result(2 * all, all);
    result.topRows(all) =
        (back + on.leftCols(n) * shared + s.leftCols(n) * (share_.asDiagonal() * down.topRows(n))).array();
    const Eigen::VectorXd direct = (-t * mu_.cwiseInverse()).array().exp().matrix();
    result.bottomRows(all) =
        (direct.asDiagonal() * down + t_below.leftCols(n) * (share_.asDiagonal() * down.topRows(n))).array();
    return result;
  }

 private:
  const GradedMedium& medium_;
  const Eigen::VectorXd& mu_;
  Eigen::VectorXd share_;  // w / 2 mu of the nodes
  std::vector<Kernel> kernels_;
};

}  // namespace

OdeSolution::OdeSolution(const GradedMedium& medium, const OdeSettings& settings, const Eigen::VectorXd& targets,
                         ThreadPool& pool)
    : nodes_(settings.nodes) {
  const int orders = needed_orders(medium, settings.nodes);
  const Quadrature quadrature(settings.nodes);
  mu_.resize(nodes_ + targets.size());
  mu_ << quadrature.mu, targets;
  weight_ = quadrature.weight;
  const Eigen::Index all = mu_.size();
  const Array inverse = mu_.cwiseInverse().array();
  Array rates(2 * all, all);
  rates.topRows(all) = inverse.replicate(1, all) + inverse.transpose().replicate(all, 1);
  rates.bottomRows(all) = inverse.transpose().replicate(all, 1);
  moments_.resize(static_cast<std::size_t>(orders));
  std::vector<int> taken(moments_.size());
  pool.run(moments_.size(), [&](std::size_t m) {
    const Terms terms(medium, orders, static_cast<int>(m), mu_, 0.5 * weight_.cwiseQuotient(quadrature.mu));
    ExponentialSteps steps(rates, settings.tolerance);
    Array& u = moments_[m];
    u = Array::Zero(2 * all, all);
    if (m == 0) {
      u.topRows(all) = 4.0 * medium.ground() * (mu_ * mu_.transpose()).array();
    }
    // Integrate upwards from knot to knot, since the profile is smooth between knots.
    double step = 1e-3 * std::min(1.0, medium.tau());
    for (std::size_t above = medium.knots().size() - 1; above-- > 0;) {
      const double bottom = medium.tau() - medium.knots()[above + 1].tau;
      const double top = medium.tau() - medium.knots()[above].tau;
      steps.integrate(bottom, top, step, u, [&](double t, const Array& now) { return terms(above, t, now); });
    }
    taken[m] = steps.taken();
  });
  steps_ = taken.front();
}

double OdeSolution::sum(bool reflect, Eigen::Index out, Eigen::Index in, double dphi) const {
  const Eigen::Index all = mu_.size();
  const Eigen::Index row = (reflect ? 0 : all) + nodes_ + out;
  double value = 0.0;
  for (std::size_t m = 0; m < moments_.size(); ++m) {
    value += (m == 0 ? 1.0 : 2.0) * std::cos(static_cast<double>(m) * dphi) * moments_[m](row, nodes_ + in);
  }
  return value / (4.0 * std::numbers::pi * mu_[nodes_ + out] * mu_[nodes_ + in]);
}

Eigen::VectorXd OdeSolution::flux(bool reflect) const {
  const Eigen::Index all = mu_.size();
  const Eigen::Index targets = all - nodes_;
  const Eigen::MatrixXd part = moments_.front().block(reflect ? 0 : all, nodes_, nodes_, targets).matrix().transpose();
  return (0.5 * part * weight_).cwiseQuotient(mu_.tail(targets));
}

}  // namespace lamina
