// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// Angle over which a lobe varies: a refracted one is narrower than its facets by the step of the index.
double lobe_width(const Facets& facets, double ior_above, double ior_below) {
  return facets.alpha * std::abs(ior_above - ior_below) / std::max(ior_above, ior_below);
}

/// Fine nodes of the first range, and azimuths: some across the lobe.
int fine_nodes(double width) {
  constexpr double kDensity = 3.5;
  constexpr int kMost = 400;
  return std::min(kMost, static_cast<int>(std::ceil(kDensity / width)));
}

int azimuth_samples(double width, int orders) {
  constexpr double kDensity = 12.0;
  constexpr int kFewest = 64;
  constexpr int kMost = 2048;
  return std::max({kFewest, 4 * orders, std::min(kMost, static_cast<int>(std::ceil(kDensity / width)))});
}

/// C = n scale of all directions, 1 at targets, 0 where there is none.
VectorXd common_scale(const Directions& directions) { return directions.ior * directions.spread(directions.scale); }

/// For each incoming direction the flux that leaves into all directions: sum over nodes of C_j M_ji.
VectorXd leaving_flux(const MatrixXd& matrix, const Directions& out) {
  return matrix.topRows(out.nodes).transpose() * common_scale(out).head(out.nodes);
}

/// What of the incident flux, C_i, is missing; rounding does not count as a gain.
VectorXd lost_flux(const Directions& in, const VectorXd& kept) { return (common_scale(in) - kept).cwiseMax(0.0); }

/// The largest relative gain of flux at any node that is not grazing: facets cannot gain, only nodes too coarse
/// for their lobes can.
double gain(const Directions& in, const VectorXd& kept) {
  constexpr double kGrazing = 0.04;
  double worst = 0.0;
  for (Eigen::Index k = 0; k < in.live; ++k) {
    if (in.mu[k] >= kGrazing) {
      worst = std::max(worst, kept[k] / (in.ior * in.scale[k]) - 1.0);
    }
  }
  return worst;
}

double node_sum(const VectorXd& values, const Directions& directions) {
  return values.head(directions.nodes).dot(common_scale(directions).head(directions.nodes));
}

void require_no_gain(double gained) {
  constexpr double kAllowed = 1e-4;
  if (gained > kAllowed) {
    std::ostringstream message;
    message << "the stack cannot be resolved: at the finest nodes a rough boundary gains " << gained
            << " of its flux (allowed " << kAllowed << "); its alpha or its step of index is too small";
    throw std::runtime_error(message.str());
  }
}

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
  const double width = lobe_width(facets, ior_above, ior_below);
  const DirectionSet fine = set.finer(fine_nodes(width));
  const AzimuthTransform azimuth(azimuth_samples(width, orders), orders);
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
  const DirectionSet fine = set.finer(fine_nodes(facets.alpha));
  const AzimuthTransform azimuth(azimuth_samples(facets.alpha, orders), orders);
  operators_.emplace_back(reflect_above_, azimuth, set, fine, ior_above, ior_above, pool);
  if (compensate_) {
    mean_fresnel_ = mean_conductor_fresnel(ratio);
    perfect_.emplace([=](double o, double i,
                         const ArrayXd& cosines) -> ArrayXd { return pi * mirror_reflection(facets, o, i, cosines); },
                     AzimuthTransform(azimuth_samples(facets.alpha, 1), 1), set, fine, ior_above, ior_above, pool);
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
      const VectorXd kept = leaving_flux(perfect_->on(above, above, pool).front(), above);
      require_no_gain(gain(above, kept));
      const VectorXd lost = lost_flux(above, kept);
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
  MatrixXd& through = orders.front().transmit.kernel;
  MatrixXd& mean_below = orders.front().reflect_below.kernel;
  const VectorXd kept_above = leaving_flux(mean_above, above) + leaving_flux(through, below);
  const VectorXd kept_below = leaving_flux(mean_below, below) + leaving_flux(through.transpose(), above);
  require_no_gain(std::max(gain(above, kept_above), gain(below, kept_below)));
  if (compensate_) {
    const VectorXd up = lost_flux(above, kept_above);
    const VectorXd down = lost_flux(below, kept_below);
    const double loss = node_sum(up, above) + node_sum(down, below);
    if (loss > 0.0) {
      mean_above += up * up.transpose() / loss;
      through += down * up.transpose() / loss;
      mean_below += down * down.transpose() / loss;
    }
  }
  return orders;
}

ArrayXd RoughSurface::reflection_above(double mu_o, double mu_i, const ArrayXd& cosines) const {
  return reflect_above_(mu_o, mu_i, cosines) / pi;
}

ArrayXd RoughSurface::reflection_below(double mu_o, double mu_i, const ArrayXd& cosines) const {
  return reflect_below_ ? (reflect_below_(mu_o, mu_i, cosines) / pi).eval() : ArrayXd::Zero(cosines.size()).eval();
}

ArrayXd RoughSurface::transmission(double mu_below, double mu_above, const ArrayXd& cosines) const {
  return transmit_ ? (transmit_(mu_below, mu_above, cosines) / pi).eval() : ArrayXd::Zero(cosines.size()).eval();
}

}  // namespace lamina
