// SPDX-License-Identifier: GPL-3.0-or-later
#include "walks/adding_walk.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "walks/layer_table.hpp"
#include "walks/stack_walk.hpp"

namespace lamina {
namespace {

using Kind = WalkElements::Element::Kind;

class LayerWalk final : public StackWalk {
 public:
  LayerWalk(WalkElements stack, const WalkTarget& target, ThreadPool& pool) : StackWalk(std::move(stack), target) {
    for (const WalkElements::Element& element : this->stack().elements) {
      tables_.emplace_back();
      Sides& sides = tables_.back();
      const Medium& medium = element.medium;
      if (element.kind != Kind::kMedium || medium.albedo == 0.0 || medium.tau == 0.0) {
        continue;
      }
      if (element.graded) {
        auto [top, bottom] = LayerTable::both_sides(*element.graded, pool);
        sides.top = std::make_shared<const LayerTable>(std::move(top));
        sides.bottom = std::make_shared<const LayerTable>(std::move(bottom));
      } else {
        sides.top = sides.bottom = std::make_shared<const LayerTable>(medium, pool);
      }
      table_error_ = std::max({table_error_, sides.top->error(), sides.bottom->error()});
    }
    begin();
    if (!is_flux() && scatters_once_only()) {
      take_no_walk();
    }
  }

  double table_error() const { return table_error_; }

 private:
  /// A layer's tables for light that enters either side; null if the layer does not scatter.
  struct Sides {
    std::shared_ptr<const LayerTable> top;
    std::shared_ptr<const LayerTable> bottom;

    const LayerTable* met_by(const Ray& ray) const { return ray.z < 0.0 ? top.get() : bottom.get(); }
  };

  /// True if at most one element scatters or reflects light. The series then has only its first term, which needs no
  /// walk.
  bool scatters_once_only() const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < stack().elements.size(); ++k) {
      const WalkElements::Element& element = stack().elements[k];
      const bool is_clear_medium = element.kind == Kind::kMedium && tables_[k].top == nullptr;
      const bool is_black = element.kind == Kind::kLambert && element.reflectance == 0.0;
      count += is_clear_medium || is_black ? 0 : 1;
    }
    return count <= 1;
  }

  bool cross(std::size_t element, const Exits& out, Light& light, bool first, double& score, Rng& rng,
             std::uint64_t& events) const override {
    ++events;
    const LayerTable* table = tables_[element].met_by(light.ray);
    if (table == nullptr) {
      return rng.uniform() < std::exp(-stack().elements[element].medium.tau / std::abs(light.ray.z));
    }
    if (!first && !is_flux()) {
      score += light.weight * leaving(element, out, light.ray);
    }
    const Ray in = light.ray;
    const bool goes_on = table->cross(light.ray, light.weight, first, rng);
    const bool passed = in.x == light.ray.x && in.y == light.ray.y && in.z == light.ray.z;
    if (goes_on && !passed && has_lobes()) {
      light.earlier = earlier(density(element, in, light.ray));
    }
    return goes_on;
  }

  double leaving(std::size_t element, const Exits& out, const Ray& in) const override {
    const LayerTable* table = tables_[element].met_by(in);
    if (table == nullptr) {
      return 0.0;
    }
    double sum = 0.0;
    for (const Exit& one : out) {
      sum += one.share * one.weighed(density(element, in, one.ray));
    }
    return sum;
  }

  /// The density of light that the layer scatters, relative to n^2 times the projected solid angle.
  double density(std::size_t element, const Ray& in, const Ray& out) const {
    const double n = stack().ior[element];
    return tables_[element].met_by(in)->value(in, out) / (n * n);
  }

  double scattered_share(std::size_t element, const Ray& in) const override {
    const LayerTable* table = tables_[element].met_by(in);
    return table != nullptr ? table->scattered(in) : 0.0;
  }

  std::vector<Sides> tables_;
  double table_error_ = 0.0;
};

}  // namespace

AddingWalk make_adding_walk(const Stack& stack, const WalkTarget& target, ThreadPool& pool) {
  auto walk = std::make_unique<LayerWalk>(WalkElements(stack, target, false), target, pool);
  const double error = walk->table_error();
  return {std::move(walk), error};
}

}  // namespace lamina
