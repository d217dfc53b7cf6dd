// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/beam_set.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "matter/single_scattering_shape.hpp"
#include "operators/interface.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// The delta parts of each layer and of the base, for the targets.
std::vector<Deltas> deltas_of(const OrientedSolution& solution, const std::vector<Directions>& gaps) {
  const Stack& stack = solution.stack();
  const Index targets = gaps.front().targets;
  std::vector<Deltas> own;
  std::size_t scatterer = 0;
  for (std::size_t layer = 0; layer <= stack.layers.size(); ++layer) {
    Deltas here{ArrayXd::Zero(targets), ArrayXd::Zero(targets), ArrayXd::Zero(targets)};
    if (layer == stack.layers.size()) {
      if (stack.base.kind == Base::Kind::kNone) {
        break;
      }
      if (stack.base.is_mirror()) {
        here.reflect_above = gaps[layer].mu.tail(targets).array().unaryExpr(
            [&](double mu) { return stack.base.mirror_reflectance(mu, gaps[layer].ior); });
      }
    } else if (const auto* interface = std::get_if<Interface>(&stack.layers[layer])) {
      if (solution.surface(layer) == nullptr) {
        const ScatteringFunction s = smooth_interface(gaps[layer], gaps[layer + 1], interface->optics(gaps[layer].ior));
        here = {s.reflect_above.delta.tail(targets), s.transmit.delta.tail(targets),
                s.reflect_below.delta.tail(targets)};
      }
    } else {
      here.transmit =
          direct_transmissions(gaps[layer].mu.tail(targets), solution.media().scatterers()[scatterer++].medium.tau);
    }
    own.push_back(std::move(here));
  }
  return own;
}

}  // namespace

BeamSet::BeamSet(const OrientedSolution& solution, std::vector<Beam> beams, ThreadPool& pool)
    : solution_(solution), beams_(std::move(beams)) {
  std::vector<double> cosines;
  for (Beam& beam : beams_) {
    cosines.push_back(beam.mu);
  }
  std::sort(cosines.begin(), cosines.end());
  cosines.erase(std::unique(cosines.begin(), cosines.end()), cosines.end());
  for (Beam& beam : beams_) {
    target_.push_back(std::lower_bound(cosines.begin(), cosines.end(), beam.mu) - cosines.begin());
    beam.phi -= solution.frame();
  }
  gaps_ = solution.directions(Eigen::Map<const VectorXd>(cosines.data(), static_cast<Index>(cosines.size())));
  deltas_ = DeltaField(deltas_of(solution, gaps_));
  scattered_ = solution.dark(static_cast<Index>(beams_.size()));
  lost_.assign(solution.stack().layers.size() + 1, std::vector<std::array<double, 2>>(beams_.size()));
  for (std::size_t k = 0; k < solution.media().scatterers().size(); ++k) {
    media_.emplace_back(solution.media(), k, gaps_[solution.media().scatterers()[k].layer], solution.azimuths().orders);
  }
  pool.run(beams_.size(), [&](std::size_t beam) {
    for (std::size_t layer = 0; layer <= solution.stack().layers.size(); ++layer) {
      add_surface(layer, beam);
    }
    for (std::size_t k = 0; k < media_.size(); ++k) {
      add_medium(solution.media().scatterers()[k].layer, media_[k], beam);
    }
  });
}

BeamSet::Arrival BeamSet::arrival(std::size_t beam, std::size_t layer) const {
  const DeltaField::Arrival& here = (beams_[beam].below ? deltas_.from_below : deltas_.from_above)[layer];
  return {here.down[target_[beam]], here.up[target_[beam]]};
}

Heading BeamSet::heading(std::size_t beam, std::size_t gap) const {
  return Heading::of(gaps_[gap].mu[gaps_[gap].live + target_[beam]], beams_[beam].phi);
}

/// Adds light that a layer emits into a gap, [live node, function].
void BeamSet::add(std::size_t gap, bool up, std::size_t beam, const MatrixXd& values) {
  const std::vector<std::vector<Index>>& functions = solution_.azimuths().functions;
  for (std::size_t block = 0; block < functions.size(); ++block) {
    MatrixXd& all = (up ? scattered_.up : scattered_.down)[block][gap];
    for (std::size_t f = 0; f < functions[block].size(); ++f) {
      all.col(static_cast<Index>(beam)).segment(static_cast<Index>(f) * values.rows(), values.rows()) +=
          values.col(functions[block][f]);
    }
  }
}

void BeamSet::add_surface(std::size_t layer, std::size_t beam) {
  const Stack& stack = solution_.stack();
  const bool is_base = layer == stack.layers.size();
  if (is_base && stack.base.is_diffuse()) {
    const Directions& here = gaps_[layer];
    MatrixXd values = MatrixXd::Zero(here.live, solution_.azimuths().count());
    values.col(0) = arrival(beam, layer).down * stack.base.reflectance / here.ior * here.scale.head(here.live);
    add(layer, true, beam, values);
    return;
  }
  const OrientedSurface* surface = solution_.surface(layer);
  if (surface == nullptr) {
    return;
  }
  const Arrival shares = arrival(beam, layer);
  for (const Face face : {Face::kTop, Face::kBottom}) {
    const bool top = face == Face::kTop;
    const double share = top ? shares.down : shares.up;
    if (!(share > 0.0) || (is_base && !top)) {
      continue;
    }
    const OrientedSurface::Column column = surface->column(face, heading(beam, top ? layer : layer + 1));
    lost_[layer][beam][top ? 0 : 1] = column.lost;
    add(layer, true, beam, share * column.above);
    if (!is_base) {
      add(layer + 1, false, beam, share * column.below);
    }
  }
}

void BeamSet::add_medium(std::size_t layer, const MediumOnTargets& medium, std::size_t beam) {
  const AzimuthBlocks& azimuths = solution_.azimuths();
  const Arrival shares = arrival(beam, layer);
  if (!(shares.down > 0.0 || shares.up > 0.0)) {
    return;
  }
  const VectorXd waves = azimuths.at(beams_[beam].phi);
  MatrixXd up(gaps_[layer].live, azimuths.count());
  MatrixXd down(gaps_[layer].live, azimuths.count());
  for (Index f = 0; f < azimuths.count(); ++f) {
    const auto order = static_cast<std::size_t>(azimuths.order_of(f));
    const auto turned = medium.reflect[order].col(target_[beam]);
    const auto passed = medium.transmit[order].col(target_[beam]);
    up.col(f) = waves[f] * (shares.down * turned + shares.up * passed);
    down.col(f) = waves[f] * (shares.down * passed + shares.up * turned);
  }
  add(layer, true, beam, up);
  add(layer + 1, false, beam, down);
}

double BeamSet::by_facets(std::size_t layer, std::size_t out, std::size_t in) const {
  const bool is_base = layer == solution_.stack().layers.size();
  const Arrival leaving = arrival(out, layer);
  const Arrival arriving = arrival(in, layer);
  double sum = 0.0;
  for (const Face from : {Face::kTop, Face::kBottom}) {
    for (const Face to : {Face::kTop, Face::kBottom}) {
      const bool on_top = from == Face::kTop;
      const bool by_top = to == Face::kTop;
      const double share = (by_top ? leaving.down : leaving.up) * (on_top ? arriving.down : arriving.up);
      if (share > 0.0 && !(is_base && !(on_top && by_top))) {
        sum += share * solution_.surface(layer)->value(
                           from, to, heading(in, on_top ? layer : layer + 1), heading(out, by_top ? layer : layer + 1),
                           lost_[layer][in][on_top ? 0 : 1], lost_[layer][out][by_top ? 0 : 1]);
      }
    }
  }
  return sum;
}

double BeamSet::by_medium(std::size_t scatterer, std::size_t out, std::size_t in) const {
  const Solution::Scatterer& own = solution_.media().scatterers()[scatterer];
  const Arrival leaving = arrival(out, own.layer);
  const Arrival arriving = arrival(in, own.layer);
  const double turned = leaving.down * arriving.down + leaving.up * arriving.up;
  const double passed = leaving.down * arriving.up + leaving.up * arriving.down;
  if (!(turned > 0.0 || passed > 0.0)) {
    return 0.0;
  }
  const double dphi = beams_[out].phi - beams_[in].phi;
  const double mu_o = heading(out, own.layer).mu;
  const double mu_i = heading(in, own.layer).mu;
  // Once, by the phase function itself.
  const double sines = std::sqrt((1.0 - mu_o * mu_o) * (1.0 - mu_i * mu_i)) * std::cos(dphi);
  const double weight = 0.25 / pi * own.medium.single_scattering_albedo() / (own.ior * own.ior);
  double sum =
      weight * (turned * single_reflection(mu_o, mu_i, own.medium.tau) * own.phase.evaluate(sines - mu_o * mu_i) +
                passed * single_transmission(mu_o, mu_i, own.medium.tau) * own.phase.evaluate(sines + mu_o * mu_i));
  // More often, by azimuth orders.
  const MediumOnTargets& medium = media_[scatterer];
  for (std::size_t m = 0; m < medium.reflect_between.size(); ++m) {
    const double wave = (m == 0 ? 1.0 : 2.0) / pi * std::cos(static_cast<double>(m) * dphi);
    sum += wave * (turned * medium.reflect_between[m](target_[out], target_[in]) +
                   passed * medium.transmit_between[m](target_[out], target_[in]));
  }
  return sum;
}

double BeamSet::by_one_layer(std::size_t out, std::size_t in) const {
  const Stack& stack = solution_.stack();
  double sum = 0.0;
  for (std::size_t layer = 0; layer <= stack.layers.size(); ++layer) {
    if (solution_.surface(layer) != nullptr) {
      sum += by_facets(layer, out, in);
    }
  }
  for (std::size_t k = 0; k < media_.size(); ++k) {
    sum += by_medium(k, out, in);
  }
  if (stack.base.is_diffuse()) {
    const double ior = gaps_.back().ior;
    sum += arrival(out, stack.layers.size()).down * arrival(in, stack.layers.size()).down * stack.base.reflectance /
           (pi * ior * ior);
  }
  return sum;
}

Deltas specular_light(const OrientedSolution& solution, const VectorXd& mu) {
  Deltas whole = Deltas::nothing(mu.size());
  for (const Deltas& one : deltas_of(solution, solution.directions(mu))) {
    whole = joined(whole, one);
  }
  return whole;
}

}  // namespace lamina
