// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/scattering_between_lobes.hpp"

#include <algorithm>
#include <cmath>

#include "solve/moments_behind_lobes.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Face kFaces[] = {Face::kTop, Face::kBottom};

const VectorXd& at_face(const DeltaField::Arrival& arrival, Face face) {
  return face == Face::kTop ? arrival.down : arrival.up;
}

}  // namespace

/// The light on one set of nodes, with one number of moments.
struct ScatteringBetweenLobes::Level {
  /// Light at the top of a medium going down and at its bottom going up: [live node or target, target].
  struct Light {
    MatrixXd down;
    MatrixXd up;
  };

  const Assembly& assembly;
  std::vector<Directions> directions;  // by gap, as in the assembly
  std::vector<TruncatedMedium> media;  // by scatterer
  std::vector<LayerShapes> shapes;
  std::vector<std::vector<std::shared_ptr<const LobeColumns>>> lobes;  // by boundary; empty: the assembly's
  std::vector<std::size_t> section;                                    // by scatterer
  std::vector<DeltaField> fields;                                      // by section
  std::vector<std::size_t> first_layer;
  int orders;

  Level(const Assembly& all, const MirrorSections& sections, std::vector<Directions> at,
        std::vector<TruncatedMedium> optics, int count)
      : assembly(all), directions(std::move(at)), media(std::move(optics)), orders(count) {
    const Solution& solution = all.solution();
    const auto cosines = [&](std::size_t gap) -> ArrayXd {
      ArrayXd mu = ArrayXd::Zero(directions[gap].nodes);
      mu.head(directions[gap].live) = directions[gap].mu.head(directions[gap].live);
      return mu;
    };
    for (std::size_t k = 0; k <= solution.boundaries().size(); ++k) {
      fields.push_back(sections.field(k, cosines));
      first_layer.push_back(sections.first_layer(k));
    }
    for (std::size_t k = 0; k < media.size(); ++k) {
      const std::size_t layer = solution.scatterers()[k].layer;
      shapes.emplace_back(directions[layer], media[k]);
      section.push_back(section_of(solution, layer));
    }
  }

  const MatrixXd& columns(std::size_t boundary, Face from, Face to, int order) const {
    if (lobes.empty()) {
      return assembly.surface(boundary).from_targets(from, to, order);
    }
    const LobeColumns& own = *lobes[boundary][from == Face::kTop ? 0 : 1];
    return (from == to ? own.reflected : own.transmitted)[static_cast<std::size_t>(order)];
  }

  /// The light of unit beams along the targets on one side of the stack; `leaving`: by reciprocity, the light that
  /// leaves the stack along the targets.
  Light light(std::size_t scatterer, Side side, bool leaving, int order) const {
    const Solution& solution = assembly.solution();
    const std::size_t layer = solution.scatterers()[scatterer].layer;
    const Directions& here = directions[layer];
    const auto& beams = side == Side::kTop ? assembly.deltas().from_above : assembly.deltas().from_below;
    const Index targets = here.targets;
    Light all{MatrixXd::Zero(here.live + targets, targets), MatrixXd::Zero(here.live + targets, targets)};
    all.down.bottomRows(targets).diagonal() = beams[layer].down.tail(targets);
    all.up.bottomRows(targets).diagonal() = beams[layer].up.tail(targets);
    const std::size_t own = section[scatterer];
    for (const bool from_above : {true, false}) {
      if ((from_above && own == 0) || (!from_above && own == solution.boundaries().size())) {
        continue;
      }
      const std::size_t b = from_above ? own - 1 : own;
      const Solution::Boundary& boundary = solution.boundaries()[b];
      const bool at_base = boundary.layer == solution.stack().layers.size();
      const Face into = from_above ? Face::kBottom : Face::kTop;
      const Directions& gap = directions[from_above ? boundary.layer + 1 : boundary.layer];
      const DeltaField& field = fields[own];
      const auto& arrival = (from_above ? field.from_above : field.from_below)[layer - first_layer[own]];
      for (const Face entering : kFaces) {
        if (at_base && entering == Face::kBottom) {
          continue;
        }
        VectorXd share = at_face(beams[boundary.layer], entering).tail(targets);
        if (share.isZero(0.0)) {
          continue;
        }
        const RoughSurface& surface = *boundary.surface;
        const auto weight = [&](double mu) { return surface.view_weight(mu); };
        if (leaving && at_base) {
          share = share.cwiseProduct(gap.mu.tail(targets).unaryExpr(weight));
        }
        const MatrixXd& lobe = columns(b, entering, into, order);
        const Index rows = std::min(lobe.rows(), here.live);
        MatrixXd spread = lobe.topRows(rows) * share.asDiagonal();
        if (!leaving && at_base) {
          spread = gap.mu.head(rows).unaryExpr(weight).asDiagonal() * spread;
        }
        all.down.topRows(rows) += arrival.down.head(rows).asDiagonal() * spread;
        all.up.topRows(rows) += arrival.up.head(rows).asDiagonal() * spread;
      }
    }
    return all;
  }

  /// The light between targets in one order, pi f: [out, in]. Targets above the stack come first, and then, unless the
  /// stack is opaque, those below it.
  MatrixXd between(int order) const {
    const bool opaque = assembly.solution().stack().base.kind != Base::Kind::kNone;
    const Index targets = directions.front().targets;
    const Index all = opaque ? targets : 2 * targets;
    MatrixXd sum = MatrixXd::Zero(all, all);
    for (std::size_t k = 0; k < media.size(); ++k) {
      if (!media[k].flakes && order >= static_cast<int>(media[k].moments.size())) {
        continue;
      }
      const Directions& here = directions[assembly.solution().scatterers()[k].layer];
      Light in = light(k, Side::kTop, false, order);
      Light out;
      if (opaque) {
        out = light(k, Side::kTop, true, order);
      } else {
        const Light below = light(k, Side::kBottom, false, order);
        for (const auto& [own, other] : {std::pair{&in.down, &below.down}, std::pair{&in.up, &below.up}}) {
          own->conservativeResize(Eigen::NoChange, all);
          own->rightCols(targets) = *other;
        }
        out = in;
      }
      LayerKernels once = single_on(here, media[k], shapes[k], order);
      // Between two targets single scattering is in closed form, see StackSingleScattering.
      once.reflect.bottomRightCorner(targets, targets).setZero();
      once.transmit.bottomRightCorner(targets, targets).setZero();
      sum += out.down.transpose() * (once.reflect * in.down + once.transmit * in.up);
      sum += out.up.transpose() * (once.reflect * in.up + once.transmit * in.down);
    }
    return sum;
  }
};

ScatteringBetweenLobes::ScatteringBetweenLobes(const Assembly& assembly, ThreadPool& pool, bool keeps_held)
    : assembly_(assembly), sections_(assembly.solution()) {
  const Solution& solution = assembly.solution();
  if (solution.boundaries().empty() || !std::isfinite(solution.resolution().tolerance)) {
    return;
  }
  std::vector<TruncatedMedium> coarse;
  std::vector<TruncatedMedium> fine;
  int moments = solution.resolution().moments();
  for (const Solution::Scatterer& scatterer : solution.scatterers()) {
    coarse.push_back(scatterer.medium);
    fine.push_back(scatterer.medium);
    if (!(scatterer.medium.albedo > 0.0) || scatterer.medium.flakes) {
      continue;
    }
    constexpr double kShare = 0.2;  // of the tolerance
    const int needed = moments_behind_lobes(solution, scatterer, kShare * solution.resolution().tolerance);
    if (needed > solution.resolution().moments()) {
      // As in closed form: the phase function itself, and the attenuation of the truncated medium.
      fine.back().albedo = scatterer.medium.single_scattering_albedo();
      fine.back().moments.clear();
      for (int l = 0; l < needed; ++l) {
        fine.back().moments.push_back(scatterer.phase.moment(l));
      }
      moments = std::max(moments, needed);
    }
  }
  coarse_ = std::make_unique<Level>(assembly, sections_, assembly.directions(), std::move(coarse), solution.orders());
  if (moments == solution.resolution().moments()) {
    return;
  }
  // A polynomial of degree L through nodes of (0, 1) needs L / sqrt(2) of them, see the density of Gauss nodes in
  // angle.
  const double nodes = 0.75 * moments + 8.0;
  const DirectionSet set = solution.direction_set().finer_by(std::max(1.0, nodes / solution.resolution().nodes));
  const std::vector<double> indices = refractive_indices(solution.stack());
  const Index targets = assembly.directions().front().targets;
  const VectorXd mu = assembly.directions().front().mu.tail(targets);  // in air
  std::vector<Directions> directions;
  for (const double ior : indices) {
    directions.push_back(set.in_medium(ior, mu));
  }
  fine_ = std::make_unique<Level>(assembly, sections_, std::move(directions), std::move(fine), moments);
  held_.resize(keeps_held ? static_cast<std::size_t>(moments) : 0);
  for (const Solution::Boundary& boundary : solution.boundaries()) {
    fine_->lobes.emplace_back();
    for (const LobeOperator& lobes : boundary.surface->lobes_on(set, moments)) {
      const std::size_t gap = boundary.layer + fine_->lobes.back().size();
      fine_->lobes.back().push_back(lobes.from_targets(fine_->directions[gap], pool));
    }
  }
}

ScatteringBetweenLobes::~ScatteringBetweenLobes() = default;

std::vector<MatrixXd> ScatteringBetweenLobes::held() const {
  const Level& level = fine_ ? *fine_ : *coarse_;
  const Index targets = level.directions.front().targets;
  std::vector<MatrixXd> orders;
  for (int m = 0; m < level.orders; ++m) {
    const auto order = static_cast<std::size_t>(m);
    const bool kept = order < held_.size() && held_[order].size() > 0;
    orders.emplace_back(kept ? held_[order] : level.between(m).topLeftCorner(targets, targets));
  }
  return orders;
}

int ScatteringBetweenLobes::orders() const {
  return fine_ ? std::max(fine_->orders, assembly_.solution().orders()) : assembly_.solution().orders();
}

ScatteringFunction ScatteringBetweenLobes::without_single(int order) const {
  const Directions& here = assembly_.directions().front();
  const Index targets = here.targets;
  ScatteringFunction rest = order < assembly_.solution().orders()
                                ? assembly_.without_single(order)
                                : ScatteringFunction::nothing(here.size(), here.nodes, here.views);
  if (!fine_) {
    return rest;
  }
  MatrixXd between = MatrixXd::Zero(2 * targets, 2 * targets);
  if (order < fine_->orders) {
    const MatrixXd fine = fine_->between(order);
    if (!held_.empty()) {
      held_[static_cast<std::size_t>(order)] = fine.topLeftCorner(targets, targets);
    }
    between.topLeftCorner(fine.rows(), fine.cols()) += fine;
  }
  if (order < coarse_->orders) {
    const MatrixXd coarse = coarse_->between(order);
    between.topLeftCorner(coarse.rows(), coarse.cols()) -= coarse;
  }
  rest.reflect_above.kernel.bottomRightCorner(targets, targets) += between.topLeftCorner(targets, targets);
  if (assembly_.solution().stack().base.kind == Base::Kind::kNone) {
    rest.reflect_below.kernel.bottomRightCorner(targets, targets) += between.bottomRightCorner(targets, targets);
    rest.transmit.kernel.bottomRightCorner(targets, targets) += between.bottomLeftCorner(targets, targets);
  }
  return rest;
}

}  // namespace lamina
