// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/solution.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "rough/shared_surface.hpp"

namespace lamina {
namespace {

/// Number of orders solved between two checks of convergence; fixed, so results do not depend on the number of threads.
constexpr int kBlock = 4;

/// The largest number of azimuth orders of flakes, which only grazing light needs.
constexpr int kMostFlakeOrders = 2000;

/// True if the multiple scattering of the medium in an azimuth order exceeds rounding errors.
bool scatters_repeatedly(const TruncatedMedium& medium, int order) {
  constexpr double kFaintest = 1e-7;  // albedo below which the difference from single scattering is rounding
  if (!(medium.albedo > kFaintest && medium.tau > kThinnestRepeated)) {
    return false;
  }
  // By Cauchy and Schwarz, light scattered twice is at most the sum of (2 l + 1) chi_l^2 from the order on. Each
  // further scattering multiplies it by at most the largest chi_l, and in a thin layer all of it is in proportion to
  // the thickness.
  if (medium.flakes) {
    return true;
  }
  double twice = 0.0;
  double largest = 0.0;
  for (std::size_t l = static_cast<std::size_t>(order); l < medium.moments.size(); ++l) {
    const double moment = medium.albedo * std::abs(medium.moments[l]);
    twice += (2.0 * static_cast<double>(l) + 1.0) * moment * moment;
    largest = std::max(largest, moment);
  }
  const double thin = medium.tau < 1.0 ? medium.tau * (1.0 - std::log(medium.tau)) : 1.0;
  return order == 0 || thin * twice > kFaintest * (1.0 - largest);
}

/// The smallest value of the phase function over the azimuth, for reflection between two directions.
double least_phase(const Solution::Scatterer& scatterer, double mu_o, double mu_i, double turn) {
  static const Eigen::ArrayXd azimuths{{-1.0, -0.5, 0.0, 0.5, 1.0}};
  return scatterer.phase_of(mu_o, mu_i, turn, azimuths).minCoeff();
}

/// The thickness of the thinnest layer that the nodes must resolve, by refractive index.
std::map<double, double> thinnest_layers(const Stack& stack, const Resolution& resolution) {
  const std::vector<double> indices = refractive_indices(stack);
  std::map<double, double> thinnest;
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    const auto* medium = std::get_if<Medium>(&stack.layers[layer]);
    if (medium != nullptr && medium->albedo > 0.0 && medium->tau > thickest_unresolved(resolution.tolerance)) {
      double& known = thinnest.try_emplace(indices[layer], 1.0).first->second;
      known = std::min(known, std::max(resolution.thinnest, medium->tau));
    }
  }
  return thinnest;
}

/// The number of boundaries that reflect, smooth or rough.
int reflectors(const Stack& stack) {
  const std::vector<double> indices = refractive_indices(stack);
  int count = stack.base.is_glossy() ? 1 : 0;
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    const auto* interface = std::get_if<Interface>(&stack.layers[layer]);
    count += interface != nullptr && interface->reflects(indices[layer]) ? 1 : 0;
  }
  return count;
}

}  // namespace

Solution::Solution(SublayerStack sublayers, const Resolution& resolution, ThreadPool& pool)
    : sublayers_(std::move(sublayers)),
      resolution_(resolution),
      set_(std::make_shared<DirectionSet>(refractive_indices(stack()), resolution.nodes,
                                          thinnest_layers(stack(), resolution))) {
  const std::vector<double> indices = refractive_indices(stack());
  for (std::size_t layer = 0; layer < stack().layers.size(); ++layer) {
    if (const auto* medium = std::get_if<Medium>(&stack().layers[layer])) {
      scatterers_.push_back({layer, indices[layer], TruncatedMedium(*medium, resolution.moments()), medium->phase});
      if (medium->flakes && medium->flakes->translucency) {
        scatterers_.back().matte = std::make_shared<const MattePhase>(*medium->flakes);
      }
      native_directions_.push_back(set_->in_medium(indices[layer], Eigen::VectorXd()));
      flakes_.push_back(medium->flakes ? std::make_shared<FlakeKernel>(*medium->flakes, native_directions_.back())
                                       : nullptr);
      modes_.push_back(std::make_shared<Modes>());
    }
  }
  solve(pool);
}

/// The number of azimuth orders that would pass the check if orders decayed as slowly as the check assumes.
double Solution::orders_needed() const {
  constexpr double kFewest = 64.0;  // with fewer orders the decay cannot be estimated
  if (orders() < kFewest) {
    return orders();
  }
  return orders() + std::log(checks_.azimuth / resolution_.tolerance) / -std::log(kSlowestDecay);
}

Resolution Solution::finer() const {
  constexpr double kHopeless = 1.75;  // safety factor: the estimate may be too large by this factor
  Resolution finer = resolution_;
  if (!(checks_.azimuth < resolution_.tolerance)) {
    // Beside rough boundaries, orders beyond those of the flakes themselves are for narrow lobes.
    const bool of_flakes = has_flakes() && !is_rough();
    const int most = of_flakes ? kMostFlakeOrders : kMostOrders;
    const bool hopeless = !of_flakes && orders_needed() > kHopeless * kMostOrders;
    const bool noisy = std::ranges::any_of(boundaries_, [](const auto& b) { return b.surface->is_noisy(); });
    if (hopeless && noisy && resolution_.nodes < nodes_beside(kMostOrders)) {
      return refined(resolution_);
    }
    if (orders() >= most || hopeless) {
      require_sound();
    }
    finer.fewest_orders = std::min(most, 8 * orders() / 5);
    if (!of_flakes) {
      finer.nodes = std::max(finer.nodes, nodes_beside(finer.fewest_orders));
    }
    return finer;
  }
  finer = refined(resolution_);
  if (finer.nodes == resolution_.nodes) {
    require_sound();
  }
  return finer;
}

/// The number of ranges of nodes in a new solve of the stack, one of whose media has the thickness `tau`.
std::size_t Solution::ranges_for(double tau) const {
  Resolution resolution = resolution_;
  resolution.thinnest = std::max(kLeastDivision, std::min(resolution.thinnest, tau));
  return DirectionSet(refractive_indices(stack()), resolution.nodes, thinnest_layers(stack(), resolution))
      .ranges()
      .size();
}

Solution Solution::with_thickness(std::size_t layer, double tau, ThreadPool& pool) const {
  const std::size_t begin = sublayers_.first.at(layer);
  const std::size_t end = sublayers_.first.at(layer + 1);
  if (begin == end || !std::holds_alternative<Medium>(stack().layers[begin])) {
    throw std::invalid_argument("with_thickness: layer " + std::to_string(layer) + " is not a medium");
  }
  Solution other = *this;
  bool grown = false;  // true if a medium grows from a thickness that the nodes need not resolve
  for (Scatterer& scatterer : other.scatterers_) {
    if (scatterer.layer >= begin && scatterer.layer < end) {
      Medium& medium = std::get<Medium>(other.sublayers_.stack.layers[scatterer.layer]);
      const double before = medium.tau;
      medium.tau = sublayers_.share[scatterer.layer] * tau;
      scatterer.medium = TruncatedMedium(medium, resolution_.moments());
      grown = grown || (medium.tau > thickest_unresolved(resolution_.tolerance) &&
                        before <= thickest_unresolved(resolution_.tolerance));
    }
  }
  // A thin medium needs ranges of grazing nodes. Without them, errors add up from lobe to lobe: up to 27 %, measured.
  const bool has_chains = is_rough() && reflectors(stack()) > 1;
  const bool resolved = !grown && !(has_chains && set_->ranges().size() < other.ranges_for(tau));
  if (!resolved && std::isfinite(resolution_.tolerance)) {
    Resolution finer = choose_resolution(other.stack(), resolution_.tolerance);
    finer.nodes = std::max(finer.nodes, resolution_.nodes);
    finer.fewest_orders = resolution_.fewest_orders;
    return {other.sublayers_, finer, pool};
  }
  other.solve(pool);
  return other;
}

Solution Solution::with_reflectance(double reflectance) const {
  if (stack().base.kind != Base::Kind::kLambert) {
    throw std::invalid_argument("with_reflectance: the base is not a Lambert surface");
  }
  Solution other = *this;
  other.sublayers_.stack.base.reflectance = reflectance;
  other.kept_tables_ = std::make_shared<KeptTables>();
  return other;
}

void Solution::solve(ThreadPool& pool) {
  const std::scoped_lock guard(*modes_lock_);
  multiple_.clear();
  kept_tables_ = std::make_shared<KeptTables>();
  checks_ = SolveChecks{};
  checks_.quadrature = set_->moment_error();
  const std::size_t media = scatterers_.size();
  const int fewest = fewest_orders();
  // The orders of flakes are not limited by nodes. Operators of rough boundaries take long in each order.
  const int of_flakes = is_rough() ? kMostFlakeOrders / 4 : kMostFlakeOrders;
  const int orders = has_flakes() ? std::max(of_flakes, resolution_.moments()) : resolution_.moments();
  const int most = resolution_.only_mean ? 1 : std::max(orders, fewest);
  for (int first = 0; first < most; first += kBlock) {
    const int last = std::min(first + kBlock, most);
    multiple_.resize(static_cast<std::size_t>(last), std::vector<MultipleScattering>(media));
    for (const auto& modes : modes_) {
      modes->resize(std::max(modes->size(), static_cast<std::size_t>(last)));
    }
    std::vector<SolveChecks> found(media * static_cast<std::size_t>(last - first));
    pool.run(found.size(), [&](std::size_t task) {
      solve_medium(first + static_cast<int>(task / media), task % media, found[task]);
    });
    for (const SolveChecks& checks : found) {
      checks_.worsen(checks);
    }
    limit_modes();
    if (last < most && last >= fewest &&
        share_of_order(last - 1) + share_of_order(last - 2) < resolution_.azimuth_tolerance) {
      break;
    }
  }
  add_boundaries(pool);
}

bool Solution::is_rough() const {
  const std::vector<double> indices = refractive_indices(stack());
  bool rough = stack().base.is_rough();
  for (std::size_t layer = 0; layer < stack().layers.size(); ++layer) {
    const auto* interface = std::get_if<Interface>(&stack().layers[layer]);
    rough = rough || (interface != nullptr && interface->is_rough(indices[layer]));
  }
  return rough;
}

bool Solution::has_flakes() const {
  return std::ranges::any_of(flakes_, [](const auto& kernel) { return kernel != nullptr; });
}

/// Drops the modes if they take too much memory (many sublayers at many orders); another thickness recomputes them.
void Solution::limit_modes() {
  constexpr double kMostBytes = 64e6;  // per solution
  double bytes = 0.0;
  for (std::size_t k = 0; k < modes_.size(); ++k) {
    const double nodes = static_cast<double>(native_directions_[k].live);
    bytes += 2.0 * sizeof(double) * nodes * nodes * static_cast<double>(modes_[k]->size());
  }
  if (bytes > kMostBytes) {
    for (const std::shared_ptr<Modes>& modes : modes_) {
      std::for_each(modes->begin(), modes->end(), [](auto& one) { one.reset(); });
    }
  }
}

void Solution::solve_medium(int order, std::size_t scatterer, SolveChecks& checks) {
  const TruncatedMedium& medium = scatterers_[scatterer].medium;
  const Directions& directions = native_directions_[scatterer];
  MultipleScattering& multiple = multiple_[static_cast<std::size_t>(order)][scatterer];
  if (!scatters_repeatedly(medium, order)) {
    return;  // empty matrices are zero
  }
  std::unique_ptr<HomogeneousModes>& modes = (*modes_[scatterer])[static_cast<std::size_t>(order)];
  const FlakeKernel* flakes = flakes_[scatterer].get();
  const PhaseKernel phase = flakes != nullptr ? flakes->order(order) : PhaseKernel(medium, order, directions.mu);
  if (!modes) {
    modes = std::make_unique<HomogeneousModes>(medium, order, directions, flakes != nullptr ? &phase : nullptr);
  }
  const HomogeneousModes::Layer solved = modes->layer(medium.tau);
  multiple = multiple_scattering(solved, medium, phase, order, directions);
  if (order == 0) {
    checks = check_layer(solved, multiple, phase, medium, directions, *set_);
    if (flakes != nullptr) {
      checks.phase = 0.0;  // exact by FlakeKernel's correction
    }
    if (medium.tau <= thickest_unresolved(resolution_.tolerance)) {
      checks.resolution = 0.0;
      checks.negativity = 0.0;
    }
  }
}

/// The largest ratio of an order's contribution to the smallest scattering of a medium over all azimuths. That smallest
/// scattering is estimated as single scattering plus a part of the mean of multiple scattering.
double Solution::share_of_order(int order) const {
  constexpr double kGrazing = 0.04;  // the tolerance holds for cosines above .05 only
  // Cosines of the nodes in the least dense medium: light that is grazing there may be steep in a denser medium.
  std::vector<double> outside;
  for (const DirectionSet::Range& range : set_->ranges()) {
    outside.insert(outside.end(), range.nodes.mu.begin(), range.nodes.mu.end());
  }
  const double least_ior = set_->ranges().front().ior;
  const auto grazes = [&](Eigen::Index node) { return outside[static_cast<std::size_t>(node)] < kGrazing; };
  // Light that cannot leave needs more orders than light that is returned.
  std::vector<bool> trapped;
  for (const DirectionSet::Range& range : set_->ranges()) {
    trapped.insert(trapped.end(), static_cast<std::size_t>(range.nodes.mu.size()), range.ior > least_ior);
  }
  double share = 0.0;
  for (std::size_t k = 0; k < scatterers_.size(); ++k) {
    const Scatterer& scatterer = scatterers_[k];
    if (!scatters_repeatedly(scatterer.medium, order)) {
      continue;
    }
    const Eigen::VectorXd& mu = native_directions_[k].mu;
    const MultipleScattering& mean = multiple_.front()[k];
    const MultipleScattering& wave = multiple_[static_cast<std::size_t>(order)][k];
    const double quarter = 0.25 * scatterer.medium.single_scattering_albedo();
    for (Eigen::Index j = 0; j < mu.size(); ++j) {
      for (Eigen::Index i = 0; i <= j; ++i) {
        if (grazes(i) || grazes(j) ||
            (flakes_[k] && (trapped[static_cast<std::size_t>(i)] || trapped[static_cast<std::size_t>(j)]))) {
          continue;
        }
        const double sines = order % 2 == 0 ? 1.0 : std::sqrt((1.0 - mu[i] * mu[i]) * (1.0 - mu[j] * mu[j]));
        const double back = quarter * least_phase(scatterer, mu[i], mu[j], -1.0) + 0.1 * mean.reflect(i, j);
        const double on = quarter * least_phase(scatterer, mu[i], mu[j], 1.0) + 0.1 * mean.transmit(i, j);
        share =
            std::max({share, std::abs(wave.reflect(i, j)) * sines / back, std::abs(wave.transmit(i, j)) * sines / on});
      }
    }
  }
  return share;
}

Eigen::ArrayXd Solution::Scatterer::phase_of(double mu_o, const Eigen::ArrayXd& mu_i, double turn,
                                             const Eigen::ArrayXd& azimuths) const {
  if (matte) {
    return (*matte)(mu_o, mu_i, turn, azimuths);
  }
  if (medium.flakes) {
    return mu_i.binaryExpr(azimuths,
                           [&](double mu, double x) { return flake_phase(*medium.flakes, mu_o, mu, turn, x); });
  }
  Eigen::ArrayXd angle = ((1.0 - mu_o * mu_o) * (1.0 - mu_i.square())).max(0.0).sqrt() * azimuths + turn * mu_o * mu_i;
  angle = angle.max(-1.0).min(1.0);
  phase.evaluate_all(angle);
  return angle;
}

std::vector<Directions> Solution::directions(const Eigen::VectorXd& targets) const {
  std::vector<Directions> all;
  for (const double ior : refractive_indices(stack())) {
    all.push_back(set_->in_medium(ior, targets));
  }
  return all;
}

/// The least number of azimuth orders. Behind rough boundaries, single scattering needs as many orders as its phase
/// function. Successive lobes need orders by their width.
int Solution::fewest_orders() const {
  int orders = resolution_.fewest_orders;
  if (!is_rough()) {
    return orders;
  }
  for (const Scatterer& scatterer : scatterers_) {
    for (int m = orders; m < static_cast<int>(scatterer.medium.moments.size()); ++m) {
      if (scatterer.medium.albedo * std::abs(scatterer.medium.moments[static_cast<std::size_t>(m)]) >
          resolution_.azimuth_tolerance) {
        orders = m + 1;
      }
    }
  }
  return std::max(orders, orders_for_lobes(stack(), resolution_.tolerance));
}

void Solution::add_boundaries(ThreadPool& pool) {
  if (boundary_orders_ >= orders()) {
    return;  // the lobes do not depend on thickness
  }
  boundaries_.clear();
  boundary_orders_ = orders();
  const std::vector<double> indices = refractive_indices(stack());
  const double fineness = reflectors(stack()) > 1 ? 2.2 : 1.0;  // measured: albedo within a few 1e-4
  for (std::size_t layer = 0; layer < stack().layers.size(); ++layer) {
    const auto* interface = std::get_if<Interface>(&stack().layers[layer]);
    if (interface != nullptr && interface->is_rough(indices[layer])) {
      boundaries_.push_back({layer, shared_surface(*interface, *set_, indices[layer], orders(), pool, fineness)});
    }
  }
  if (stack().base.is_rough()) {
    boundaries_.push_back({stack().layers.size(), shared_surface(stack().base, *set_, indices.back(), orders(), pool,
                                                                 fineness, resolution_.tolerance)});
  }
  // Evaluate once, so that lobes that are too narrow throw here and not in a later evaluation.
  const std::vector<Directions> here = directions(Eigen::VectorXd());
  for (const Boundary& boundary : boundaries_) {
    boundary.surface->on(here[boundary.layer], here[std::min(boundary.layer + 1, here.size() - 1)], pool);
  }
}

void Solution::require_sound() const {
  const std::string problem = checks_.problem(resolution_.tolerance);
  if (!problem.empty()) {
    throw std::runtime_error("the stack cannot be resolved with " + std::to_string(resolution_.nodes) +
                             " nodes per hemisphere: " + problem);
  }
}

}  // namespace lamina
