// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// Fine nodes of the first range; a refracted lobe is narrower than its facets by the step of the index.
int fine_nodes(const Facets& facets, double index_step) {
  constexpr double kAcross = 5.0;
  constexpr int kMost = 320;
  const double width = facets.alpha * std::clamp(2.0 * index_step, 0.2, 1.0);
  return std::min(kMost, static_cast<int>(std::ceil(kAcross / width)));
}

int azimuth_samples(const Facets& facets, int orders) {
  constexpr int kFewest = 64;
  return std::max({kFewest, 4 * orders, static_cast<int>(std::ceil(12.0 / facets.alpha))});
}

/// C = n scale of all directions, 1 at targets, 0 where there is none.
VectorXd common_scale(const Directions& directions) { return directions.ior * directions.spread(directions.scale); }

/// For each incoming direction the flux that leaves into all directions: sum over nodes of C_j M_ji.
VectorXd leaving_flux(const MatrixXd& matrix, const Directions& out) {
  return matrix.topRows(out.nodes).transpose() * common_scale(out).head(out.nodes);
}

/// What of the incident flux, C_i, is missing; rounding does not count as a gain.
VectorXd lost_flux(const Directions& in, const VectorXd& kept) { return (common_scale(in) - kept).cwiseMax(0.0); }

double node_sum(const VectorXd& values, const Directions& directions) {
  return values.head(directions.nodes).dot(common_scale(directions).head(directions.nodes));
}

ArrayXd one_azimuth(double dphi) { return ArrayXd::Constant(1, std::cos(dphi)); }

}  // namespace

int orders_for(double alpha) { return static_cast<int>(std::ceil(6.0 / alpha)); }

RoughSurface::RoughSurface(const Interface& interface, const DirectionSet& set, double ior_above, int orders,
                           ThreadPool& pool)
    : compensate_(interface.compensate) {
  const Facets facets = interface.facets;
  const double ior_below = interface.ior;
  reflect_above_ = [=](double o, double i, const ArrayXd& cosines) -> ArrayXd {
    return pi * dielectric_reflection(facets, ior_above, ior_below, o, i, cosines);
  };
  reflect_below_ = [=](double o, double i, const ArrayXd& cosines) -> ArrayXd {
    return pi * dielectric_reflection(facets, ior_below, ior_above, o, i, cosines);
  };
  transmit_ = [=](double below, double above, const ArrayXd& cosines) -> ArrayXd {
    return pi * ior_above * ior_below * dielectric_transmission(facets, ior_above, ior_below, above, below, cosines);
  };
  const DirectionSet fine = set.finer(fine_nodes(facets, std::abs(ior_below - ior_above)));
  const AzimuthTransform azimuth(azimuth_samples(facets, orders), orders);
  operators_.emplace_back(reflect_above_, azimuth, set, fine, ior_above, ior_above, pool);
  operators_.emplace_back(transmit_, azimuth, set, fine, ior_below, ior_above, pool);
  operators_.emplace_back(reflect_below_, azimuth, set, fine, ior_below, ior_below, pool);
}

RoughSurface::RoughSurface(const Base& conductor, const DirectionSet& set, double ior_above, int orders,
                           ThreadPool& pool)
    : compensate_(conductor.compensate) {
  const Facets facets = conductor.facets;
  const std::complex<double> ratio = conductor.ior / ior_above;
  reflect_above_ = [=](double o, double i, const ArrayXd& cosines) -> ArrayXd {
    return pi * conductor_reflection(facets, ratio, o, i, cosines);
  };
  const DirectionSet fine = set.finer(fine_nodes(facets, 1.0));
  const AzimuthTransform azimuth(azimuth_samples(facets, orders), orders);
  operators_.emplace_back(reflect_above_, azimuth, set, fine, ior_above, ior_above, pool);
  if (compensate_) {
    mean_fresnel_ = mean_conductor_fresnel(ratio);
    perfect_.emplace([=](double o, double i,
                         const ArrayXd& cosines) -> ArrayXd { return pi * mirror_reflection(facets, o, i, cosines); },
                     AzimuthTransform(azimuth_samples(facets, 1), 1), set, fine, ior_above, ior_above, pool);
  }
}

std::vector<ScatteringFunction> RoughSurface::on(const Directions& above, const Directions& below,
                                                 ThreadPool& pool) const {
  std::vector<MatrixXd> reflected = operators_.front().on(above, above, pool);
  std::vector<ScatteringFunction> orders;
  for (MatrixXd& matrix : reflected) {
    orders.push_back(ScatteringFunction::nothing(above.size(), above.nodes));
    orders.back().reflect_above.kernel = std::move(matrix);
  }
  MatrixXd& mean_above = orders.front().reflect_above.kernel;
  if (operators_.size() == 1) {
    if (perfect_) {
      const VectorXd lost = lost_flux(above, leaving_flux(perfect_->on(above, above, pool).front(), above));
      const double loss = node_sum(lost, above);
      if (loss > 0.0) {
        // Reflected again and again, each time with the mean reflectance, until it gets out.
        const double share = loss / node_sum(common_scale(above), above);
        const double again = mean_fresnel_ * mean_fresnel_ * (1.0 - share) / (1.0 - mean_fresnel_ * share);
        mean_above += again / loss * lost * lost.transpose();
      }
    }
    return orders;
  }
  std::vector<MatrixXd> passed = operators_[1].on(below, above, pool);
  std::vector<MatrixXd> returned = operators_[2].on(below, below, pool);
  for (std::size_t m = 0; m < orders.size(); ++m) {
    orders[m].transmit.kernel = std::move(passed[m]);
    orders[m].reflect_below.kernel = std::move(returned[m]);
  }
  if (compensate_) {
    MatrixXd& through = orders.front().transmit.kernel;
    MatrixXd& mean_below = orders.front().reflect_below.kernel;
    const VectorXd up = lost_flux(above, leaving_flux(mean_above, above) + leaving_flux(through, below));
    const VectorXd down = lost_flux(below, leaving_flux(mean_below, below) + leaving_flux(through.transpose(), above));
    const double loss = node_sum(up, above) + node_sum(down, below);
    if (loss > 0.0) {
      mean_above += up * up.transpose() / loss;
      through += down * up.transpose() / loss;
      mean_below += down * down.transpose() / loss;
    }
  }
  return orders;
}

double RoughSurface::reflection_above(double mu_o, double mu_i, double dphi) const {
  return reflect_above_(mu_o, mu_i, one_azimuth(dphi))[0] / pi;
}

double RoughSurface::reflection_below(double mu_o, double mu_i, double dphi) const {
  return reflect_below_ ? reflect_below_(mu_o, mu_i, one_azimuth(dphi))[0] / pi : 0.0;
}

double RoughSurface::transmission(double mu_below, double mu_above, double dphi) const {
  return transmit_ ? transmit_(mu_below, mu_above, one_azimuth(dphi))[0] / pi : 0.0;
}

}  // namespace lamina
