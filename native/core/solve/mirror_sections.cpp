// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/mirror_sections.hpp"

#include <algorithm>
#include <cmath>

#include "matter/smooth_boundary.hpp"

namespace lamina {

using Eigen::ArrayXd;

MirrorSections::MirrorSections(const Solution& solution)
    : solution_(solution), indices_(refractive_indices(solution.stack())) {
  for (const Solution::Scatterer& scatterer : solution.scatterers()) {
    media_.push_back({scatterer.layer, &scatterer.medium});
  }
  const std::size_t layers = solution.stack().layers.size();
  std::size_t first = 0;
  for (const Solution::Boundary& boundary : solution.boundaries()) {
    sections_.push_back({first, boundary.layer});
    first = boundary.layer + 1;
  }
  sections_.push_back({first, std::max(first, layers + 1)});
}

Deltas MirrorSections::layer(std::size_t layer, const Cosines& cosines) const {
  const Stack& stack = solution_.stack();
  const ArrayXd above = cosines(layer);
  Deltas deltas = Deltas::nothing(above.size());
  if (layer == stack.layers.size()) {
    if (stack.base.is_mirror()) {
      const double ior = indices_.back();
      deltas.reflect_above =
          above.unaryExpr([&](double mu) { return mu > 0.0 ? stack.base.mirror_reflectance(mu, ior) : 1.0; });
    }
    if (stack.base.kind != Base::Kind::kNone) {
      deltas.transmit.setZero();
    }
    return deltas;
  }
  if (const auto* interface = std::get_if<Interface>(&stack.layers[layer])) {
    const ArrayXd below = cosines(layer + 1);
    const FacetOptics optics = interface->optics(indices_[layer]);
    for (Eigen::Index k = 0; k < above.size(); ++k) {
      const SmoothBoundary boundary(optics, above[k], below[k]);
      deltas.reflect_above[k] = boundary.above;
      deltas.reflect_below[k] = boundary.below;
      deltas.transmit[k] = boundary.passed;
    }
    return deltas;
  }
  const auto medium = std::find_if(media_.begin(), media_.end(), [&](const Medium& m) { return m.layer == layer; });
  constexpr double kLeast = 1e-300;  // replaces the cosine 0 of a direction that does not exist
  deltas.transmit = direct_transmissions(above.max(kLeast).matrix(), *medium->optics).array();
  return deltas;
}

Deltas MirrorSections::section(std::size_t section, const Cosines& cosines) const {
  const Section& s = sections_[section];
  if (s.first == s.last) {
    return Deltas::nothing(cosines(std::min(s.first, solution_.stack().layers.size())).size());
  }
  Deltas all = layer(s.first, cosines);
  for (std::size_t k = s.first + 1; k < s.last; ++k) {
    all = joined(all, layer(k, cosines));
  }
  return all;
}

DeltaField MirrorSections::field(std::size_t section, const Cosines& cosines) const {
  std::vector<Deltas> layers;
  for (std::size_t k = sections_[section].first; k < sections_[section].last; ++k) {
    layers.push_back(layer(k, cosines));
  }
  return DeltaField(layers);
}

}  // namespace lamina
