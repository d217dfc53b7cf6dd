// SPDX-License-Identifier: GPL-3.0-or-later
#include "rough/rough_surface.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "rough/merged_modes.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// C = n scale of all directions: 1 at targets, 0 where the direction does not exist in the medium.
VectorXd common_scale(const Directions& directions) { return directions.ior * directions.spread(directions.scale); }

/// The flux that leaves into all directions, for each incoming direction i: sum over nodes of C_j M_ji.
VectorXd leaving_flux(const MatrixXd& matrix, const Directions& out) {
  return matrix.topRows(out.nodes).transpose() * common_scale(out).head(out.nodes);
}

/// The missing part of the incident flux C_i; a gain by rounding counts as 0.
VectorXd lost_flux(const Directions& in, const VectorXd& kept) { return (common_scale(in) - kept).cwiseMax(0.0); }

/// The largest relative gain of flux, over all nodes together and over each target that is not grazing. Facets cannot
/// gain flux, so a gain means that the quadrature is too coarse.
double gain(const Directions& in, const VectorXd& kept) {
  constexpr double kGrazing = 0.04;
  const VectorXd gained = kept - common_scale(in);
  const VectorXd nodes = common_scale(in).head(in.nodes);
  double worst = gained.head(in.nodes).dot(nodes) / nodes.squaredNorm();
  for (Eigen::Index t = 0; t < in.targets; ++t) {
    if (in.mu[in.live + t] >= kGrazing) {
      worst = std::max(worst, gained[in.nodes + t]);
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
    message << "the stack cannot be resolved: a rough boundary or a measured base gains " << gained
            << " of its flux (allowed " << kAllowed << ")";
    throw std::runtime_error(message.str());
  }
}

MatrixXd merged(const MatrixXd& reflection, const Modes& modes) {
  const MatrixXd once = merged(reflection, reflection, modes, modes);
  return 0.5 * (once + once.transpose());  // removes the asymmetry of rounding
}

/// Restores on the diagonal of a reflection the flux out of each node that merging changed.
void restore(MatrixXd& reflection, const VectorXd& exact, const VectorXd& kept, const VectorXd& common) {
  reflection.diagonal() += (exact - kept).cwiseQuotient(common);
}

MatrixXd merged_keeping_flux(const MatrixXd& one, const Modes& modes, const Directions& nodes) {
  MatrixXd reflection = merged(one, modes);
  const VectorXd common = nodes.ior * nodes.scale;
  restore(reflection, one.transpose() * common, reflection * common, common);
  return reflection;
}

FacetRays::Pieces pieces(const DirectionSet& set, double ior, double beyond, int orders, double fineness) {
  constexpr double kPerOrder = 1.2;
  double degree = kPerOrder * orders;
  for (const DirectionSet::Range& range : set.ranges()) {
    degree = std::max(degree, fineness * static_cast<double>(range.nodes.mu.size()));
  }
  return {static_cast<int>(degree), set.ends(ior), beyond > 0.0 ? set.ends(beyond) : std::vector<double>()};
}

/// Writes one part of an operator: its block on live nodes, and the columns and rows of targets. `arriving`: light that
/// comes in along targets; `leaving`: light that goes out along targets, by incoming live nodes.
void fill(MatrixXd& kernel, const Directions& out, const Directions& in, const MatrixXd& nodes,
          const MatrixXd& arriving, const MatrixXd& leaving) {
  kernel.topLeftCorner(out.live, in.live) = nodes;
  kernel.block(0, in.nodes, out.live, in.targets) = arriving;
  kernel.block(out.nodes, 0, out.targets, in.live) = leaving;
}

}  // namespace

RoughSurface::RoughSurface(const Interface& interface, const DirectionSet& set, double ior_above, int orders,
                           ThreadPool& pool, double fineness)
    : facets_(interface.facets),
      above_(interface.optics(ior_above)),
      below_(above_.turned()),
      compensate_(facets_.compensate) {
  const double ior_below = interface.ior;
  from_above_.emplace(FacetRays(facets_, above_, pieces(set, ior_above, ior_below, orders, fineness)), set, ior_above,
                      ior_below, orders);
  from_below_.emplace(FacetRays(facets_, below_, pieces(set, ior_below, ior_above, orders, fineness)), set, ior_below,
                      ior_above, orders);
  LobeColumns above = from_above_->on_nodes(pool);
  LobeColumns below = from_below_->on_nodes(pool);
  const Directions over = set.in_medium(ior_above, VectorXd());
  const Directions under = set.in_medium(ior_below, VectorXd());
  const Modes modes_over(set, over);
  const Modes modes_under(set, under);
  for (std::size_t m = 0; m < above.reflected.size(); ++m) {
    nodes_.push_back({merged(above.reflected[m], modes_over),
                      merged(above.transmitted[m], below.transmitted[m], modes_under, modes_over),
                      merged(below.reflected[m], modes_under)});
    if (m > 0) {
      for (MatrixXd* done : {&above.reflected[m], &above.transmitted[m], &below.reflected[m], &below.transmitted[m]}) {
        *done = MatrixXd();
      }
    }
  }
  const VectorXd c_over = over.ior * over.scale;
  const VectorXd c_under = under.ior * under.scale;
  Nodes& flux = nodes_.front();
  restore(flux.reflect_above,
          above.reflected.front().transpose() * c_over + above.transmitted.front().transpose() * c_under,
          flux.reflect_above * c_over + flux.transmit.transpose() * c_under, c_over);
  restore(flux.reflect_below,
          below.reflected.front().transpose() * c_under + below.transmitted.front().transpose() * c_over,
          flux.reflect_below * c_under + flux.transmit * c_over, c_under);
}

RoughSurface::RoughSurface(const Base& base, const DirectionSet& set, double ior_above, int orders, ThreadPool& pool,
                           double fineness, double tolerance)
    : facets_(base.facets),
      base_(base),
      reflectance_(base.facet_reflectance(ior_above)),
      above_(base.optics(ior_above)),
      below_(above_),
      compensate_(base.compensates()) {
  const FacetRays::Pieces own = pieces(set, ior_above, 0.0, orders, fineness);
  from_above_.emplace(FacetRays(base, ior_above, own), set, ior_above, 0.0, orders);
  const Directions over = set.in_medium(ior_above, VectorXd());
  const Modes modes(set, over);
  std::vector<MatrixXd> reflected;
  if (!base.measured && !facets_.retro) {
    const LobeValues lobe = [this](double mu, const FacetPairs& pairs) {
      return values(Face::kTop, Face::kTop, mu, pairs);
    };
    resolved_.emplace(lobe, set, ior_above, facets_.alpha, orders);
    reflected = resolved_->on_nodes(pool);
    if (!(resolved_->interpolation_error(reflected, pool) < 0.5 * std::min(tolerance, 1e-2))) {
      constexpr double kNarrowest = 0.03;  // narrower lobes need more nodes than a solve has
      is_noisy_ = facets_.alpha >= kNarrowest;
      reflected.clear();
      resolved_.reset();
    }
  }
  if (reflected.empty()) {
    for (const MatrixXd& matrix : from_above_->on_nodes(pool).reflected) {
      reflected.push_back(reflected.empty() ? merged_keeping_flux(matrix, modes, over) : merged(matrix, modes));
    }
  }
  for (MatrixXd& matrix : reflected) {
    nodes_.push_back({std::move(matrix), MatrixXd(), MatrixXd()});
  }
  if (compensate_) {
    mean_fresnel_ = above_.mean_reflectance();
    perfect_.emplace(FacetRays(facets_, [](double) { return 1.0; }, own), set, ior_above, 0.0, 1);
    perfect_nodes_ = merged_keeping_flux(perfect_->on_nodes(pool).reflected.front(), modes, over);
  }
}

RoughSurface::Operators RoughSurface::on(const Directions& above, const Directions& below, ThreadPool& pool) const {
  Operators operators(*this, above, below);
  operators.downward_ = resolved_ ? resolved_->from_targets(above, pool) : from_above_->from_targets(above, pool);
  if (from_below_) {
    operators.upward_ = from_below_->from_targets(below, pool);
  }
  operators.compensate(pool);
  return operators;
}

std::vector<FacetRays> RoughSurface::rays_on(const DirectionSet& set, int degree) const {
  std::vector<FacetRays> rays;
  const std::vector<double> above = set.ends(above_.here);
  if (base_) {
    rays.emplace_back(*base_, above_.here, FacetRays::Pieces{degree, above, {}});
  } else {
    const std::vector<double> below = set.ends(below_.here);
    rays.emplace_back(facets_, above_, FacetRays::Pieces{degree, above, below});
    rays.emplace_back(facets_, below_, FacetRays::Pieces{degree, below, above});
  }
  return rays;
}

std::vector<LobeOperator> RoughSurface::lobes_on(const DirectionSet& set, int orders) const {
  std::vector<LobeOperator> lobes;
  for (FacetRays& rays : rays_on(set, orders)) {
    const FacetOptics& own = optics(lobes.empty() ? Face::kTop : Face::kBottom);
    lobes.emplace_back(std::move(rays), set, own.here, base_ ? 0.0 : own.beyond, orders);
  }
  return lobes;
}

const MatrixXd& RoughSurface::Operators::from_targets(Face from, Face to, int m) const {
  const LobeColumns& columns = from == Face::kTop ? *downward_ : *upward_;
  return (from == to ? columns.reflected : columns.transmitted)[static_cast<std::size_t>(m)];
}

ScatteringFunction RoughSurface::Operators::lobes(int m) const {
  const auto k = static_cast<std::size_t>(m);
  const Nodes& nodes = surface_->nodes_[k];
  ScatteringFunction order = ScatteringFunction::nothing(above_->size(), above_->nodes);
  const MatrixXd& reflected = downward_->reflected[k];
  fill(order.reflect_above.kernel, *above_, *above_, nodes.reflect_above, reflected, reflected.transpose());
  if (upward_) {
    const MatrixXd& returned = upward_->reflected[k];
    fill(order.transmit.kernel, *below_, *above_, nodes.transmit, downward_->transmitted[k],
         upward_->transmitted[k].transpose());
    fill(order.reflect_below.kernel, *below_, *below_, nodes.reflect_below, returned, returned.transpose());
  }
  return order;
}

ScatteringFunction RoughSurface::Operators::order(int m) const {
  ScatteringFunction order = lobes(m);
  if (!surface_->is_reciprocal()) {
    const VectorXd weights = above_->mu.unaryExpr([&](double mu) { return surface_->view_weight(mu); });
    order.reflect_above.kernel = above_->spread(weights).asDiagonal() * order.reflect_above.kernel;
  }
  if (m == 0 && share_ > 0.0) {
    order.reflect_above.kernel += share_ * lost_above_ * lost_above_.transpose();
    if (upward_) {
      order.transmit.kernel += share_ * lost_below_ * lost_above_.transpose();
      order.reflect_below.kernel += share_ * lost_below_ * lost_below_.transpose();
    }
  }
  return order;
}

/// Finds what single scattering by facets loses in each direction. Throws std::runtime_error if it gains.
void RoughSurface::Operators::compensate(ThreadPool& pool) {
  if (upward_) {
    const ScatteringFunction mean = lobes(0);
    const MatrixXd& through = mean.transmit.kernel;
    const VectorXd kept_above = leaving_flux(mean.reflect_above.kernel, *above_) + leaving_flux(through, *below_);
    const VectorXd kept_below =
        leaving_flux(mean.reflect_below.kernel, *below_) + leaving_flux(through.transpose(), *above_);
    require_no_gain(std::max(gain(*above_, kept_above), gain(*below_, kept_below)));
    if (surface_->compensate_) {
      lost_above_ = lost_flux(*above_, kept_above);
      lost_below_ = lost_flux(*below_, kept_below);
      const double loss = node_sum(lost_above_, *above_) + node_sum(lost_below_, *below_);
      share_ = loss > 0.0 ? 1.0 / loss : 0.0;
    }
  } else if (surface_->base_->measured) {
    require_no_gain(gain(*above_, leaving_flux(lobes(0).reflect_above.kernel, *above_)));
  } else if (surface_->perfect_) {
    const MatrixXd whole = surface_->perfect_->from_targets(*above_, pool)->reflected.front();
    MatrixXd all = MatrixXd::Zero(above_->size(), above_->size());
    fill(all, *above_, *above_, surface_->perfect_nodes_, whole, whole.transpose());
    const VectorXd kept = leaving_flux(all, *above_);
    require_no_gain(gain(*above_, kept));
    lost_above_ = lost_flux(*above_, kept);
    const double loss = node_sum(lost_above_, *above_);
    if (loss > 0.0) {
      // Lost light is reflected repeatedly, each time with the mean reflectance, until it leaves (Kulla and Conty).
      const double lost = loss / node_sum(common_scale(*above_), *above_);
      const double fresnel = surface_->mean_fresnel_;
      share_ = fresnel * fresnel * (1.0 - lost) / (1.0 - fresnel * lost) / loss;
    }
  }
}

template <typename... Towards>
auto RoughSurface::lobe(Face from, Face to, double mu_from, const Towards&... towards) const {
  const FacetOptics& own = optics(from);
  if (from != to) {
    return facet_transmission(facets_, own, mu_from, towards...);
  }
  auto reflected = base_ && base_->measured ? base_->measured->values(mu_from, towards...)
                   : is_reciprocal()        ? facet_reflection(facets_, own, mu_from, towards...)
                                            : opaque_reflection(facets_, reflectance_, mu_from, towards...);
  reflected /= own.here * own.here;
  return reflected;
}

ArrayXd RoughSurface::value(Face from, Face to, double mu_from, double mu_to, const ArrayXd& cosines) const {
  if (!exists(from, to)) {
    return ArrayXd::Zero(cosines.size());
  }
  return view_weight(mu_to) * lobe(from, to, mu_from, mu_to, cosines);
}

ArrayXXd RoughSurface::values(Face from, Face to, double mu_from, const FacetPairs& pairs) const {
  return exists(from, to) ? lobe(from, to, mu_from, pairs) : ArrayXXd::Zero(pairs.cosines.rows(), pairs.cosines.cols());
}

}  // namespace lamina
