// SPDX-License-Identifier: GPL-3.0-or-later
// Specular light in the parts of a stack between its rough boundaries.
#pragma once
#include <functional>
#include <vector>

#include "operators/delta_field.hpp"
#include "solve/solution.hpp"

namespace lamina {

/// Specular light in the sections of a stack between its rough boundaries. Section k lies above rough boundary k, the
/// last section below all of them. A section consists of media, smooth boundaries and smooth bases.
class MirrorSections {
 public:
  explicit MirrorSections(const Solution& solution);

  /// The delta parts of one section. `cosines(gap)` returns the cosines of all directions in the medium above layer
  /// `gap` (one past the layers: below the last), 0 where a direction does not exist.
  using Cosines = std::function<Eigen::ArrayXd(std::size_t gap)>;
  Deltas section(std::size_t section, const Cosines& cosines) const;
  /// Specular light at the layers of one section, from the layer first_layer(section) on, for light that the rough
  /// boundaries at its ends send into it.
  DeltaField field(std::size_t section, const Cosines& cosines) const;
  std::size_t first_layer(std::size_t section) const { return sections_[section].first; }

 private:
  struct Medium {
    std::size_t layer;
    const TruncatedMedium* optics;
  };
  /// Layers [first, last); the base counts as the layer after the last.
  struct Section {
    std::size_t first;
    std::size_t last;
  };
  Deltas layer(std::size_t layer, const Cosines& cosines) const;

  const Solution& solution_;
  std::vector<double> indices_;
  std::vector<Medium> media_;
  std::vector<Section> sections_;
};

}  // namespace lamina
