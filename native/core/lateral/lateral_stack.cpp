// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/lateral_stack.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "operators/base_reflection.hpp"
#include "operators/interface.hpp"
#include "solve/resolution.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The least cosine that nodes must resolve, by refractive index: the optical thickness of the thinnest layer with
/// multiple scattering; in an almost clear layer, a cosine at which light travels far along the layer. The slices of a
/// graded medium are one layer.
std::map<double, double> least_cosines(const MeasuredStack& measured, const std::vector<double>& indices) {
  constexpr double kClear = 0.3;
  constexpr double kGrazing = 0.02;
  std::map<double, double> least;
  for (std::size_t layer = 0; layer < measured.stack.layers.size(); ++layer) {
    const auto* medium = std::get_if<Medium>(&measured.stack.layers[layer]);
    if (medium == nullptr || !(measured.thickness[layer] > 0.0)) {
      continue;
    }
    const double tau = measured.whole_tau[layer];
    double cosine = 1.0;
    if (medium->albedo > 0.0 && tau > kThinnestRepeated) {
      cosine = std::max(kLeastDivision, tau);
    } else if (tau < kClear) {
      cosine = kGrazing;
    }
    double& known = least.try_emplace(indices[layer], 1.0).first->second;
    known = std::min(known, cosine);
  }
  return least;
}

/// Weights that give the flux leaving along the nodes of a medium from radiance by rows: mean over azimuths times C.
VectorXd flux_weights(const Directions& directions, const LateralRows& rows) {
  VectorXd common = VectorXd::Zero(rows.nodes);
  common.head(directions.live) = directions.ior * directions.scale.head(directions.live);
  VectorXd weights = VectorXd::Zero(rows.size());
  for (Index j = 0; j < rows.azimuths.count; ++j) {
    weights.segment(j * rows.nodes, rows.nodes) = rows.azimuths.to_orders(0, j) * common;
  }
  return weights;
}

}  // namespace

LateralStack::LateralStack(const MeasuredStack& measured, const LateralResolution& resolution, double mu,
                           ThreadPool& pool)
    : measured_(measured), resolution_(resolution), mu_(mu) {
  const Stack& stack = measured_.stack;
  const std::vector<double> indices = refractive_indices(stack);
  const DirectionSet whole(indices, resolution.nodes, least_cosines(measured_, indices));
  set_ = resolution.forward > 0 ? whole.divided(kForward, resolution.forward) : whole;
  const DirectionSet& set = *set_;
  for (const double ior : indices) {
    directions_.push_back(set.in_medium(ior, VectorXd::Constant(1, mu)));
  }
  media_.resize(stack.layers.size());
  rough_.resize(stack.layers.size() + 1);
  const int orders = static_cast<int>(resolution.azimuths);
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    if (const auto* medium = std::get_if<Medium>(&stack.layers[layer])) {
      if (measured.thickness[layer] > 0.0) {
        media_[layer].emplace(*medium, resolution.moments(), directions_[layer], measured.extinction[layer],
                              measured.thickness[layer]);
      }
    } else if (const auto* interface = std::get_if<Interface>(&stack.layers[layer])) {
      if (interface->is_rough(indices[layer])) {
        add_rough(std::make_unique<RoughSurface>(*interface, set, indices[layer], orders, pool), layer, pool);
      }
    }
  }
  if (stack.base.is_rough()) {
    add_rough(std::make_unique<RoughSurface>(stack.base, set, indices.back(), orders, pool), stack.layers.size(), pool);
  }
}

void LateralStack::resolve_passing() {
  constexpr double kFiner = 8.0;
  const DirectionSet fine = set_->finer_by(kFiner);
  const MatrixXd carry = set_->carry_to(fine);
  for (std::size_t layer = 0; layer < media_.size(); ++layer) {
    if (media_[layer]) {
      const Directions here = fine.in_medium(directions_[layer].ior, VectorXd());
      media_[layer]->resolve_passing(here.mu, carry.topLeftCorner(here.live, directions_[layer].live));
    }
  }
}

void LateralStack::add_rough(std::unique_ptr<RoughSurface> surface, std::size_t layer, ThreadPool& pool) {
  const Directions& above = directions_[layer];
  const Directions& below = directions_[std::min(layer + 1, directions_.size() - 1)];
  rough_[layer] = std::make_unique<Rough>();
  rough_[layer]->surface = std::move(surface);
  Rough& rough = *rough_[layer];
  const RoughSurface::Operators operators = rough.surface->on(above, below, pool);
  const VectorXd over = above.ior * above.scale.head(above.live);
  const VectorXd under = below.ior * below.scale.head(below.live);
  const ScatteringFunction mean = operators.order(0);
  const auto keep = [&](std::size_t side, const MatrixXd& kernel, Face to, const VectorXd& common) {
    rough.spread[side] = kernel.col(above.nodes).head(common.size()).cwiseProduct(common);
    rough.repeated[side] = rough.spread[side] - operators.from_targets(Face::kTop, to, 0).col(0).cwiseProduct(common);
  };
  keep(0, mean.reflect_above.kernel, Face::kTop, over);
  if (layer < media_.size()) {
    keep(1, mean.transmit.kernel, Face::kBottom, under);
    const MatrixXd through = mean.transmit.kernel.topLeftCorner(below.live, above.live);
    rough.passed = {(through.transpose() * under).cwiseQuotient(over), (through * over).cwiseQuotient(under)};
  }
  Lobes& lobes = rough.lobes;
  for (int m = 0; m < operators.orders(); ++m) {
    ScatteringFunction order = m == 0 ? mean : operators.order(m);
    lobes.up.emplace_back(order.transmit.kernel.transpose());
    lobes.reflect_above.push_back(std::move(order.reflect_above.kernel));
    lobes.down.push_back(std::move(order.transmit.kernel));
    lobes.reflect_below.push_back(std::move(order.reflect_below.kernel));
  }
}

LateralFunction LateralStack::boundary(std::size_t layer, const LateralRows& rows) const {
  if (const Rough* rough = rough_[layer].get()) {
    const Lobes& lobes = rough->lobes;
    return {from_orders(lobes.reflect_above, rows), from_orders(lobes.down, rows),
            from_orders(lobes.reflect_below, rows), from_orders(lobes.up, rows)};
  }
  const ScatteringFunction smooth =
      smooth_interface(directions_[layer], directions_[layer + 1],
                       std::get<Interface>(measured_.stack.layers[layer]).optics(directions_[layer].ior));
  const MatrixXd through = from_delta(smooth.transmit.delta, rows);
  return {from_delta(smooth.reflect_above.delta, rows), through, from_delta(smooth.reflect_below.delta, rows), through};
}

/// The reflection operator of the base; empty if nothing is below.
MatrixXd LateralStack::base(const LateralRows& rows) const {
  const Base& base = measured_.stack.base;
  const Directions& above = directions_.back();
  if (base.is_rough()) {
    return from_orders(rough_.back()->lobes.reflect_above, rows);
  }
  if (base.is_mirror()) {
    return from_delta(base_deltas(base, above).reflect_above.delta, rows);
  }
  if (base.is_diffuse()) {
    return from_orders({base_reflection(base, 0, above).reflect_above.kernel}, rows);
  }
  return {};
}

/// Joins layers from the bottom up, then follows the beam down. `layer_of` gives the function of each medium.
template <typename LayerOf>
LateralFlux LateralStack::joined(const LateralRows& rows, const LayerOf& layer_of) const {
  struct Step {
    LateralFunction layer;
    MatrixXd below;  // reflection of everything below; empty if nothing is below
    std::optional<Eigen::PartialPivLU<MatrixXd>> between;
  };
  std::vector<Step> steps;  // bottom first
  MatrixXd reflect = base(rows);
  const std::vector<Layer>& layers = measured_.stack.layers;
  std::vector<std::size_t> present;
  for (std::size_t layer = layers.size(); layer-- > 0;) {
    if (media_[layer] || std::holds_alternative<Interface>(layers[layer])) {
      present.push_back(layer);
    }
  }
  for (const std::size_t layer : present) {
    Step& step = steps.emplace_back();
    step.layer = media_[layer] ? layer_of(*media_[layer]) : boundary(layer, rows);
    step.below = std::move(reflect);
    if (step.below.size() > 0) {
      MatrixXd between = -step.layer.reflect_below * step.below;
      between.diagonal().array() += 1.0;
      step.between.emplace(between);
    }
    if (layer == present.back()) {
      break;
    }
    reflect = step.layer.reflect_above;
    if (step.between) {
      reflect.noalias() += step.layer.up * (step.below * step.between->solve(step.layer.down));
    }
  }
  // The beam is the mean over azimuths (order 0), measured from the direction of the wave.
  VectorXd down = VectorXd::Zero(rows.size());
  down.tail(rows.beam_azimuths.count) = rows.beam_azimuths.from_orders.col(0);
  VectorXd up = steps.empty() && reflect.size() > 0 ? VectorXd(reflect * down) : VectorXd::Zero(rows.size());
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const bool top = step == steps.rbegin();
    if (top) {
      up = step->layer.reflect_above * down;
    }
    down = step->layer.down * down;
    if (step->between) {
      down = step->between->solve(down);
      if (top) {
        up += step->layer.up * (step->below * down);
      }
    }
  }
  const auto beam = [&](const VectorXd& light) {
    return rows.beam_azimuths.to_orders.row(0).dot(light.tail(rows.beam_azimuths.count));
  };
  LateralFlux flux;
  flux.mirrored = beam(up);
  flux.reflected = flux_weights(directions_.front(), rows).dot(up) + flux.mirrored;
  if (measured_.stack.base.kind == Base::Kind::kNone) {
    flux.unscattered = beam(down);
    flux.transmitted = flux_weights(directions_.back(), rows).dot(down) + flux.unscattered;
  }
  return flux;
}

LateralFlux LateralStack::at(double q, const AzimuthRule& azimuths) const {
  const AzimuthRule mean = AzimuthRule::mean();
  const LateralRows rows{azimuths, along_normal() ? mean : azimuths, directions_.front().nodes};
  return joined(rows, [&](const LateralMedium& medium) { return medium.at(q, rows); });
}

LateralFlux LateralStack::at_infinity() const {
  const AzimuthRule mean = AzimuthRule::mean();
  // An oblique beam leaves every medium beside the point of entry.
  const AzimuthRule other(along_normal() ? 1 : 2, 0.0, 1);
  const LateralRows rows{mean, other, directions_.front().nodes};
  return joined(rows, [&](const LateralMedium& medium) { return medium.at_infinity(rows); });
}

}  // namespace lamina
