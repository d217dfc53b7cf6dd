// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/oriented_solution.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "operators/interface.hpp"
#include "oriented/medium_orders.hpp"
#include "oriented/shared_oriented_surface.hpp"
#include "solve/sublayer_choice.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

/// The facets of a layer, or one past the layers of the base; null if it is no rough surface.
const Facets* facets_of(const Stack& stack, std::size_t layer) {
  if (layer == stack.layers.size()) {
    return stack.base.is_rough() ? &stack.base.facets : nullptr;
  }
  const auto* interface = std::get_if<Interface>(&stack.layers[layer]);
  return interface != nullptr && interface->facets.alpha > 0.0 ? &interface->facets : nullptr;
}

/// The stack with smooth boundaries, for the media alone.
SublayerStack without_facets(SublayerStack given) {
  for (Layer& layer : given.stack.layers) {
    if (auto* interface = std::get_if<Interface>(&layer)) {
      interface->facets.alpha = 0.0;
    }
  }
  given.stack.base.facets.alpha = 0.0;
  return given;
}

Solution solved_media(const SublayerStack& media, double tolerance, int nodes, ThreadPool& pool) {
  Resolution resolution = choose_resolution(media.stack, tolerance);
  resolution.nodes = nodes;
  resolution.thinnest = 0.05;  // grazing light in thin layers is resolved by no more nodes
  resolution.tolerance = std::numeric_limits<double>::infinity();
  Solution solution(media, resolution, pool);
  solution.require_sound();
  return solution;
}

/// The angle of the first anisotropic surface.
double first_angle(const Stack& stack) {
  for (std::size_t layer = 0; layer <= stack.layers.size(); ++layer) {
    const Facets* facets = facets_of(stack, layer);
    if (facets != nullptr && facets->is_oriented()) {
      return facets->angle;
    }
  }
  return 0.0;
}

/// True if all tangents lie along or across the x axis after a turn of the stack.
bool is_mirrored(const Stack& stack, double frame) {
  constexpr double kRounding = 1e-12;
  for (std::size_t layer = 0; layer <= stack.layers.size(); ++layer) {
    const Facets* facets = facets_of(stack, layer);
    if (facets != nullptr && facets->is_oriented() && std::abs(std::sin(2.0 * (facets->angle - frame))) > kRounding) {
      return false;
    }
  }
  return true;
}

/// The order of each function of a block.
std::vector<std::size_t> orders_of(const AzimuthBlocks& azimuths, std::size_t block) {
  std::vector<std::size_t> orders;
  for (const Index function : azimuths.functions[block]) {
    orders.push_back(static_cast<std::size_t>(azimuths.order_of(function)));
  }
  return orders;
}

BlockLayer medium_layer(const std::shared_ptr<const MediumOnNodes>& own, const std::vector<std::size_t>& orders) {
  const auto part = [&](const OrderMatrices& matrices) {
    return BlockOperator::isotropic(std::shared_ptr<const OrderMatrices>(own, &matrices), orders);
  };
  return {part(own->reflect), part(own->transmit), part(own->reflect)};
}

/// Throws for a rough boundary between indices so near to each other that its refracted lobes are too narrow.
void refuse_nearly_matched(const Stack& stack) {
  constexpr double kNarrowest = 0.01;  // values beside highlights are off by up to four fifths, see docs/limits.md
  const std::vector<double> indices = refractive_indices(stack);
  for (std::size_t layer = 0; layer < stack.layers.size(); ++layer) {
    const Facets* facets = facets_of(stack, layer);
    if (facets == nullptr || indices[layer] == indices[layer + 1]) {
      continue;
    }
    const double width = std::abs(indices[layer + 1] - indices[layer]) * std::min(facets->alpha, facets->across());
    if (width < kNarrowest) {
      std::ostringstream message;
      message << "the stack cannot be resolved: facets between the indices " << indices[layer] << " and "
              << indices[layer + 1] << " refract light into lobes of width " << width
              << ", which is too narrow for a solve with anisotropic facets (at least " << kNarrowest
              << "); a smooth boundary can be resolved";
      throw std::runtime_error(message.str());
    }
  }
}

}  // namespace

OrientedResolution choose_oriented_resolution(const Stack& stack, double tolerance) {
  constexpr double kNarrowest = 0.03;
  double narrowest = 1.0;
  for (std::size_t layer = 0; layer <= stack.layers.size(); ++layer) {
    if (const Facets* facets = facets_of(stack, layer)) {
      narrowest = std::min({narrowest, facets->alpha, facets->across()});
    }
  }
  if (narrowest < kNarrowest) {
    std::ostringstream message;
    message << "the stack cannot be resolved: facets of width " << narrowest
            << " are too narrow for a solve with anisotropic facets (at least " << kNarrowest << ")";
    throw std::runtime_error(message.str());
  }
  refuse_nearly_matched(stack);
  // Measured: errors of all light but the first reflection are .05 % at widths of .08, and .2 % at .05; for previews
  // .5 % and 1 %.
  const bool narrow = narrowest < 0.08;
  const bool rough = tolerance > 5e-3;
  OrientedResolution resolution = rough ? OrientedResolution{16, narrow ? 24 : 16, 24}
                                        : OrientedResolution{24,
                                                             narrowest < 0.05 ? 44
                                                             : narrow         ? 36
                                                                              : 32,
                                                             64};
  // Phase functions may need more nodes than facets.
  const int needed =
      choose_resolution(without_facets(SublayerStack(stack, std::vector<double>(stack.layers.size(), 2.0))).stack,
                        tolerance)
          .nodes;
  constexpr int kUsual = 32;  // nodes of any stack, see choose_resolution
  if (needed > kUsual) {
    resolution.nodes = std::max(resolution.nodes, needed);
  }
  return resolution;
}

OrientedSolution::OrientedSolution(const Stack& stack, double tolerance, const OrientedResolution& resolution,
                                   ThreadPool& pool)
    : OrientedSolution(resolved_sublayers(stack, tolerance, pool), tolerance, resolution, pool) {}

OrientedSolution::OrientedSolution(SublayerStack sublayers, double tolerance, const OrientedResolution& resolution,
                                   ThreadPool& pool)
    : stack_(sublayers.stack),
      media_(solved_media(without_facets(std::move(sublayers)), tolerance, resolution.nodes, pool)),
      frame_(first_angle(stack_)),
      azimuths_(resolution.orders, is_mirrored(stack_, frame_)),
      gaps_(media_.directions(VectorXd())),
      checks_(media_.checks()) {
  if (!stack_.base.is_reciprocal() || stack_.base.measured || stack_.base.facets.retro) {
    throw std::runtime_error("anisotropic facets cannot be solved above this kind of base");
  }
  add_surfaces(resolution.fineness, pool);
  add_layers(pool);
  between_.resize(azimuths_.functions.size());
  below_top_.resize(azimuths_.functions.size());
  pool.run(between_.size(), [&](std::size_t block) { join(block); });
  if (base_surface_ && !stack_.layers.empty()) {
    // The layers above hold all reflections of the base, and the blocks take much memory.
    base_.clear();
    base_surface_->forget_blocks();
  }
}

void OrientedSolution::add_surfaces(int fineness, ThreadPool& pool) {
  const DirectionSet& set = media_.direction_set();
  surfaces_.resize(stack_.layers.size() + 1);
  for (std::size_t layer = 0; layer <= stack_.layers.size(); ++layer) {
    const Facets* facets = facets_of(stack_, layer);
    if (facets == nullptr) {
      continue;
    }
    const double here = gaps_[layer].ior;
    const FacetOptics optics = layer == stack_.layers.size() ? stack_.base.optics(here)
                                                             : std::get<Interface>(stack_.layers[layer]).optics(here);
    const Facets turned = facets->is_oriented() ? facets->turned(-frame_) : *facets;
    if (optics.metal) {
      base_surface_ = std::make_shared<OrientedSurface>(turned, optics, set, azimuths_, fineness, pool);
      surfaces_[layer] = base_surface_;
    } else {
      surfaces_[layer] = shared_oriented_surface(turned, optics, set, azimuths_, fineness, pool);
    }
  }
}

void OrientedSolution::add_layers(ThreadPool& pool) {
  const std::size_t count = stack_.layers.size();
  const std::size_t blocks = azimuths_.functions.size();
  std::vector<std::shared_ptr<const MediumOnNodes>> solved(media_.scatterers().size());
  pool.run(solved.size(), [&](std::size_t k) {
    solved[k] = std::make_shared<MediumOnNodes>(media_, k, gaps_[media_.scatterers()[k].layer], azimuths_.orders);
  });
  const auto base_kernel = std::make_shared<OrderMatrices>();
  const Base& base = stack_.base;
  const Directions& bottom = gaps_.back();
  if (base.is_diffuse()) {
    base_kernel->assign(static_cast<std::size_t>(azimuths_.orders), MatrixXd::Zero(bottom.live, bottom.live));
    base_kernel->front() = base.reflectance * bottom.scale * bottom.scale.transpose();
  }
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::vector<std::size_t> orders = orders_of(azimuths_, b);
    std::vector<BlockLayer> layers;
    std::size_t medium = 0;
    for (std::size_t layer = 0; layer < count; ++layer) {
      const Directions& above = gaps_[layer];
      const Directions& below = gaps_[layer + 1];
      if (surfaces_[layer]) {
        const OrientedSurface::Block& own = surfaces_[layer]->block(b);
        layers.push_back({BlockOperator::coupled(own.reflect_above), BlockOperator::coupled(own.transmit),
                          BlockOperator::coupled(own.reflect_below)});
      } else if (const auto* interface = std::get_if<Interface>(&stack_.layers[layer])) {
        const ScatteringFunction s = smooth_interface(above, below, interface->optics(above.ior));
        layers.push_back(
            {BlockOperator::specular(s.reflect_above.delta.head(above.live), above.live, above.live),
             BlockOperator::specular(s.transmit.delta.head(std::min(above.live, below.live)), below.live, above.live),
             BlockOperator::specular(s.reflect_below.delta.head(below.live), below.live, below.live)});
      } else {
        layers.push_back(medium_layer(solved[medium++], orders));
      }
    }
    layers_.push_back(std::move(layers));
    BlockOperator below;
    if (surfaces_[count]) {
      below = BlockOperator::coupled(surfaces_[count]->block(b).reflect_above);
    } else if (base.is_mirror()) {
      const VectorXd mirrored = bottom.mu.unaryExpr([&](double mu) { return base.mirror_reflectance(mu, bottom.ior); });
      below = BlockOperator::specular(mirrored, bottom.live, bottom.live);
    } else if (base.is_diffuse()) {
      below = BlockOperator::isotropic(base_kernel, orders);
    }
    base_.push_back(std::move(below));
  }
}

Index OrientedSolution::size(std::size_t block, std::size_t gap) const {
  return gaps_[gap].live * static_cast<Index>(azimuths_.functions[block].size());
}

bool OrientedSolution::has_medium_on_top() const {
  return !stack_.layers.empty() && std::holds_alternative<Medium>(stack_.layers.front());
}

/// The light between a layer and all that lies below it, Q, for the reflection `below` of the latter.
MatrixXd OrientedSolution::reflected_between(std::size_t block, std::size_t layer, const MatrixXd& below) const {
  // Q is symmetric: Q = (1 - B R')^-1 B.
  MatrixXd system = -layers_[block][layer].reflect_below.times(below, size(block, layer + 1)).transpose();
  system.diagonal().array() += 1.0;
  const MatrixXd q = Eigen::PartialPivLU<Eigen::Ref<MatrixXd>>(system).solve(below);  // in place
  return 0.5 * (q + q.transpose());
}

OrientedSolution OrientedSolution::with_top_thickness(double tau, ThreadPool& pool) const {
  if (!has_medium_on_top()) {
    throw std::invalid_argument("with_top_thickness: the top layer is not a homogeneous medium");
  }
  OrientedSolution other = *this;
  other.media_ = media_.with_thickness(0, tau, pool);
  std::get<Medium>(other.stack_.layers.front()).tau = tau;
  other.checks_ = other.media_.checks();
  const auto own = std::make_shared<const MediumOnNodes>(other.media_, 0, gaps_.front(), azimuths_.orders);
  pool.run(between_.size(), [&](std::size_t block) {
    other.layers_[block].front() = medium_layer(own, orders_of(azimuths_, block));
    if (!between_[block].front().size()) {
      return;
    }
    other.between_[block].front() = other.reflected_between(block, 0, below_top_[block].cast<double>()).cast<float>();
  });
  return other;
}

void OrientedSolution::join(std::size_t block) {
  const std::vector<BlockLayer>& layers = layers_[block];
  std::vector<Eigen::MatrixXf>& between = between_[block];
  between.resize(layers.size());
  bool dark = base_[block].is_zero();
  MatrixXd below = MatrixXd::Zero(size(block, layers.size()), size(block, layers.size()));
  base_[block].add_to(below);
  for (std::size_t k = layers.size(); k-- > 0;) {
    const Index above = size(block, k);
    if (k == 0 && has_medium_on_top()) {
      below_top_[block] = below.cast<float>();
    }
    if (!dark) {
      const MatrixXd q = reflected_between(block, k, below);
      between[k] = q.cast<float>();
      if (k > 0) {
        const MatrixXd half = layers[k].transmit.transposed_times(q, above);
        below = layers[k].transmit.transposed_times(half.transpose(), above);
      }
    }
    if (k == 0) {
      return;
    }
    if (dark) {
      below = MatrixXd::Zero(above, above);
    }
    layers[k].reflect_above.add_to(below);
    dark = false;
  }
}

GapLight OrientedSolution::dark(Index problems) const {
  GapLight light;
  for (std::size_t block = 0; block < azimuths_.functions.size(); ++block) {
    std::vector<MatrixXd> gaps;
    for (std::size_t gap = 0; gap < gaps_.size(); ++gap) {
      gaps.push_back(MatrixXd::Zero(size(block, gap), problems));
    }
    light.up.push_back(gaps);
    light.down.push_back(std::move(gaps));
  }
  return light;
}

GapLight OrientedSolution::light(GapLight light) const {
  for (std::size_t block = 0; block < azimuths_.functions.size(); ++block) {
    const std::vector<BlockLayer>& layers = layers_[block];
    std::vector<MatrixXd>& up = light.up[block];
    std::vector<MatrixXd>& down = light.down[block];
    const auto rows = [&](std::size_t gap) { return size(block, gap); };
    const auto returned = [&](std::size_t k, const MatrixXd& columns) -> MatrixXd {
      const Eigen::MatrixXf& q = between_[block][k];
      return q.size() == 0 ? MatrixXd::Zero(columns.rows(), columns.cols())
                           : MatrixXd((q * columns.cast<float>()).cast<double>());
    };
    // Upwards: the light that leaves the layers below each gap if nothing enters them from above.
    std::vector<MatrixXd> back(layers.size());
    for (std::size_t k = layers.size(); k-- > 0;) {
      down[k + 1] += layers[k].reflect_below.times(up[k + 1], rows(k + 1));
      back[k] = returned(k, down[k + 1]);
      up[k] += layers[k].transmit.transposed_times(back[k] + up[k + 1], rows(k));
    }
    // Downwards, with all reflections below.
    for (std::size_t k = 0; k < layers.size(); ++k) {
      if (k > 0 || !down[0].isZero(0.0)) {
        const MatrixXd entering = layers[k].transmit.times(down[k], rows(k + 1));
        const MatrixXd more = returned(k, entering);
        if (k == 0) {
          // Light that enters from outside was not part of the upward sweep.
          up[0] += layers[0].reflect_above.times(down[0], rows(0)) + layers[0].transmit.transposed_times(more, rows(0));
        }
        down[k + 1] += entering;
        back[k] += more;
      }
      down[k + 1] += layers[k].reflect_below.times(back[k], rows(k + 1));
      up[k + 1] += back[k];
    }
    if (layers.empty()) {
      up[0] += base_[block].times(down[0], rows(0));
    }
  }
  return light;
}

}  // namespace lamina
