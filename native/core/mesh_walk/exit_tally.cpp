// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/exit_tally.hpp"

namespace lamina {

void ExitSums::add(const ExitSums& other) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    for (std::size_t k = 0; k < channels[c].moments.size(); ++k) {
      channels[c].moments[k] += other.channels[c].moments[k];
    }
    for (std::size_t k = 0; k < channels[c].products.size(); ++k) {
      channels[c].products[k] += other.channels[c].products[k];
    }
  }
}

bool ExitTally::leaves(const Exit& exit) {
  const double r = start_.distance(exit.place);
  for (std::size_t c = 0; c < kChannels; ++c) {
    const double w = exit.weights[c];
    const std::array<double, ExitSums::kScores> scored = {w, w * r, w * r * r};
    ExitSums::OfChannel& sums = sums_.channels[c];
    std::size_t product = 0;
    for (std::size_t i = 0; i < scored.size(); ++i) {
      sums.moments[i] += scored[i];
      for (std::size_t j = i; j < scored.size(); ++j) {
        sums.products[product++] += scored[i] * scored[j];
      }
    }
  }
  return false;
}

}  // namespace lamina
