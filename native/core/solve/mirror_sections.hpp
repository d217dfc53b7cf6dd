// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a stack between its rough boundaries: attenuation and mirror images only.
#pragma once
#include <functional>
#include <vector>

#include "operators/delta_field.hpp"
#include "solve/solution.hpp"

namespace lamina {

/// The parts of a stack between its rough boundaries: what light does there that nothing scatters. Section k lies above
/// rough boundary k, the last one below all of them; it is made of media, smooth boundaries and smooth bases.
class MirrorSections {
 public:
  explicit MirrorSections(const Solution& solution);

  /// Of one section; `cosines(gap)` gives those of all wanted directions in the medium above layer `gap` (one past the
  /// layers: below the last), 0 where a direction does not exist.
  using Cosines = std::function<Eigen::ArrayXd(std::size_t gap)>;
  Deltas section(std::size_t section, const Cosines& cosines) const;

 private:
  struct Medium {
    std::size_t layer;
    double tau;  // of the truncated medium
  };
  /// Layers [first, last), where the base is one past the stack's layers.
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
