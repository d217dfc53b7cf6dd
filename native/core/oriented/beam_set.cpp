// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/beam_set.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "matter/single_scattering_shape.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

namespace {

/// The distinct cosines of beams, ascending.
VectorXd cosines_of(const std::vector<Beam>& beams) {
  std::vector<double> cosines;
  for (const Beam& beam : beams) {
    cosines.push_back(beam.mu);
  }
  std::sort(cosines.begin(), cosines.end());
  cosines.erase(std::unique(cosines.begin(), cosines.end()), cosines.end());
  return Eigen::Map<const VectorXd>(cosines.data(), static_cast<Index>(cosines.size()));
}

}  // namespace

BeamSet::BeamSet(const OrientedSolution& solution, const std::vector<Beam>& beams, ThreadPool& pool)
    : solution_(solution), cosines_(cosines_of(beams)), paths_(solution, cosines_) {
  for (const Beam& beam : beams) {
    const Index target = std::lower_bound(cosines_.begin(), cosines_.end(), beam.mu) - cosines_.begin();
    beams_.push_back({target, beam.phi - solution.frame(), beam.below});
  }
  const std::vector<Directions>& gaps = paths_.gaps();
  scattered_ = solution.dark(0);
  for (std::size_t layer = 0; layer <= solution.stack().layers.size(); ++layer) {
    if (solution.surface(layer) != nullptr || (layer == gaps.size() - 1 && solution.stack().base.is_diffuse())) {
      open(layer);
    }
  }
  lost_.assign(solution.stack().layers.size() + 1, std::vector<std::array<double, 2>>(beams_.size()));
  for (std::size_t k = 0; k < solution.media().scatterers().size(); ++k) {
    const Solution::Scatterer& own = solution.media().scatterers()[k];
    media_.emplace_back(solution.media(), k, gaps[own.layer], solution.azimuths().orders);
    if (own.medium.tau > 0.0) {
      open(own.layer);
    }
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

BeamSet::BeamSet(const OrientedSolution& solution, const BeamSet& bare, ThreadPool& pool)
    : solution_(solution),
      cosines_(bare.cosines_),
      paths_(solution, cosines_),
      beams_(bare.beams_),
      media_(bare.media_),
      lost_(bare.lost_),
      scattered_(bare.scattered_) {
  media_.front() = MediumOnTargets(solution.media(), 0, paths_.gaps().front(), solution.azimuths().orders);
  const VectorXd through = direct_transmissions(cosines_, solution.media().scatterers().front().medium.tau);
  for (auto* gaps : {&scattered_.up, &scattered_.down}) {
    for (std::vector<MatrixXd>& block : *gaps) {
      for (MatrixXd& gap : block) {
        for (Index beam = 0; beam < gap.cols(); ++beam) {
          gap.col(beam) *= through[beams_[static_cast<std::size_t>(beam)].target];
        }
      }
    }
  }
  open(0);
  pool.run(beams_.size(), [&](std::size_t beam) { add_medium(0, media_.front(), beam); });
}

/// Makes place for the light that a layer or the base scatters.
void BeamSet::open(std::size_t layer) {
  const auto zero = [&](MatrixXd& gap) { gap.setZero(gap.rows(), static_cast<Index>(beams_.size())); };
  for (std::size_t block = 0; block < scattered_.up.size(); ++block) {
    zero(scattered_.up[block][layer]);
    if (layer < solution_.stack().layers.size()) {
      zero(scattered_.down[block][layer + 1]);
    }
  }
}

/// Adds light that a layer emits into a gap, [live node, function].
void BeamSet::add(std::size_t gap, bool up, std::size_t beam, const MatrixXd& values) {
  const std::vector<std::vector<Index>>& functions = solution_.azimuths().functions;
  for (std::size_t block = 0; block < functions.size(); ++block) {
    MatrixXd& all = (up ? scattered_.up : scattered_.down)[block][gap];
    for (std::size_t f = 0; all.cols() > 0 && f < functions[block].size(); ++f) {
      all.col(static_cast<Index>(beam)).segment(static_cast<Index>(f) * values.rows(), values.rows()) +=
          values.col(functions[block][f]);
    }
  }
}

void BeamSet::add_surface(std::size_t layer, std::size_t beam) {
  const Stack& stack = solution_.stack();
  const bool is_base = layer == stack.layers.size();
  if (is_base && stack.base.is_diffuse()) {
    const Directions& here = paths_.gaps()[layer];
    MatrixXd values = MatrixXd::Zero(here.live, solution_.azimuths().count());
    values.col(0) =
        paths_.arrival(beams_[beam], layer).down * stack.base.reflectance / here.ior * here.scale.head(here.live);
    add(layer, true, beam, values);
    return;
  }
  const OrientedSurface* surface = solution_.surface(layer);
  if (surface == nullptr) {
    return;
  }
  const SpecularPaths::Arrival shares = paths_.arrival(beams_[beam], layer);
  for (const Face face : {Face::kTop, Face::kBottom}) {
    const bool top = face == Face::kTop;
    const double share = top ? shares.down : shares.up;
    if (!(share > 0.0) || (is_base && !top)) {
      continue;
    }
    const OrientedSurface::Column column = surface->column(face, paths_.heading(beams_[beam], top ? layer : layer + 1));
    lost_[layer][beam][top ? 0 : 1] = column.lost;
    add(layer, true, beam, share * column.above);
    if (!is_base) {
      add(layer + 1, false, beam, share * column.below);
    }
  }
}

void BeamSet::add_medium(std::size_t layer, const MediumOnTargets& medium, std::size_t beam) {
  const AzimuthBlocks& azimuths = solution_.azimuths();
  const SpecularPaths::Arrival shares = paths_.arrival(beams_[beam], layer);
  if (!(shares.down > 0.0 || shares.up > 0.0)) {
    return;
  }
  const VectorXd waves = azimuths.at(beams_[beam].phi);
  MatrixXd up(paths_.gaps()[layer].live, azimuths.count());
  MatrixXd down(paths_.gaps()[layer].live, azimuths.count());
  for (Index f = 0; f < azimuths.count(); ++f) {
    const auto order = static_cast<std::size_t>(azimuths.order_of(f));
    const auto turned = medium.reflect[order].col(beams_[beam].target);
    const auto passed = medium.transmit[order].col(beams_[beam].target);
    up.col(f) = waves[f] * (shares.down * turned + shares.up * passed);
    down.col(f) = waves[f] * (shares.down * passed + shares.up * turned);
  }
  add(layer, true, beam, up);
  add(layer + 1, false, beam, down);
}

double BeamSet::by_medium(std::size_t scatterer, std::size_t out, std::size_t in, double dphi) const {
  const Solution::Scatterer& own = solution_.media().scatterers()[scatterer];
  const SpecularPaths::Arrival leaving = paths_.arrival(beams_[out], own.layer);
  const SpecularPaths::Arrival arriving = paths_.arrival(beams_[in], own.layer);
  const double turned = leaving.down * arriving.down + leaving.up * arriving.up;
  const double passed = leaving.down * arriving.up + leaving.up * arriving.down;
  if (!(turned > 0.0 || passed > 0.0)) {
    return 0.0;
  }
  const double mu_o = paths_.heading(beams_[out], own.layer).mu;
  const double mu_i = paths_.heading(beams_[in], own.layer).mu;
  // Once, by the phase function itself.
  const double sines = std::sqrt((1.0 - mu_o * mu_o) * (1.0 - mu_i * mu_i)) * std::cos(dphi);
  const double weight = 0.25 / pi * own.medium.single_scattering_albedo() / (own.ior * own.ior);
  double sum =
      weight * (turned * single_reflection(mu_o, mu_i, own.medium.tau) * own.phase.evaluate(sines - mu_o * mu_i) +
                passed * single_transmission(mu_o, mu_i, own.medium.tau) * own.phase.evaluate(sines + mu_o * mu_i));
  // More often, by azimuth orders.
  const MediumOnTargets& medium = media_[scatterer];
  const double turn_cosine = std::cos(dphi);
  double before = turn_cosine;  // cosines of m - 1 and of m times dphi, by recurrence
  double here = 1.0;
  for (std::size_t m = 0; m < medium.reflect_between.size(); ++m) {
    const double wave = (m == 0 ? 1.0 : 2.0) / pi * here;
    sum += wave * (turned * medium.reflect_between[m](beams_[out].target, beams_[in].target) +
                   passed * medium.transmit_between[m](beams_[out].target, beams_[in].target));
    before = std::exchange(here, 2.0 * turn_cosine * here - before);
  }
  return sum;
}

double BeamSet::by_one_layer(std::size_t out, std::size_t in) const {
  double sum = evenly(out, in) + by_media(out, in, beams_[out].phi - beams_[in].phi);
  for (std::size_t layer = 0; layer <= solution_.stack().layers.size(); ++layer) {
    if (solution_.surface(layer) != nullptr) {
      sum += paths_.by_facets(beams_[out], beams_[in], layer);
    }
  }
  return sum;
}

double BeamSet::evenly(std::size_t out, std::size_t in) const {
  const Stack& stack = solution_.stack();
  double sum = 0.0;
  for (std::size_t layer = 0; layer <= stack.layers.size(); ++layer) {
    if (const OrientedSurface* surface = solution_.surface(layer)) {
      paths_.over_faces(layer, beams_[out], beams_[in], [&](Face from, Face to, double share) {
        sum += share * surface->returned(lost_[layer][in][from == Face::kTop ? 0 : 1],
                                         lost_[layer][out][to == Face::kTop ? 0 : 1]);
      });
    }
  }
  if (stack.base.is_diffuse()) {
    const double ior = paths_.gaps().back().ior;
    const auto down = [&](std::size_t beam) { return paths_.arrival(beams_[beam], stack.layers.size()).down; };
    sum += down(out) * down(in) * stack.base.reflectance / (pi * ior * ior);
  }
  return sum;
}

double BeamSet::by_media(std::size_t out, std::size_t in, double dphi) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < media_.size(); ++k) {
    sum += by_medium(k, out, in, dphi);
  }
  return sum;
}

}  // namespace lamina
