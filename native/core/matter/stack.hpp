// SPDX-License-Identifier: GPL-3.0-or-later
// A stack: media and boundaries, top first, on a base.
#pragma once
#include <algorithm>
#include <memory>
#include <variant>
#include <vector>

#include "matter/base.hpp"
#include "matter/graded_medium.hpp"
#include "matter/medium.hpp"
#include "matter/microfacet.hpp"

namespace lamina {

/// A boundary between two dielectrics. `ior` is the absolute refractive index below it, down to the next interface;
/// above the first interface is air, of index 1. Smooth when facets.alpha is 0.
struct Interface {
  double ior = 1.5;
  Facets facets{.alpha = 0.0};
  std::shared_ptr<const Film> film = {};  ///< null without films

  /// False between media of the same index, where light passes straight.
  bool reflects(double ior_above) const { return film || ior != ior_above; }
  bool is_rough(double ior_above) const { return facets.alpha > 0.0 && reflects(ior_above); }
  FacetOptics optics(double ior_above) const { return {ior_above, ior, {}, film}; }
};

using Layer = std::variant<Medium, Interface, GradedMedium>;

/// One channel of a stack, top layer first. A half-space is a last layer of infinite thickness.
struct Stack {
  std::vector<Layer> layers;
  Base base;
};

/// True if all layers are homogeneous media without flakes, over nothing or a Lambert surface.
inline bool has_only_media(const Stack& stack) {
  return stack.base.is_none_or_lambert() &&
         std::all_of(stack.layers.begin(), stack.layers.end(), [](const Layer& layer) {
           const auto* medium = std::get_if<Medium>(&layer);
           return medium != nullptr && !medium->flakes;
         });
}

/// The refractive index above each layer, then the one below the last.
inline std::vector<double> refractive_indices(const Stack& stack) {
  std::vector<double> indices{1.0};
  for (const Layer& layer : stack.layers) {
    const auto* boundary = std::get_if<Interface>(&layer);
    indices.push_back(boundary != nullptr ? boundary->ior : indices.back());
  }
  return indices;
}

}  // namespace lamina
