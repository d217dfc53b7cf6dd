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
    for (std::size_t k = 0; k < channels[c].late.size(); ++k) {
      channels[c].late[k] += other.channels[c].late[k];
    }
  }
}

bool ExitTally::leaves(const Meeting& exit) {
  const double r = start_.distance(exit.place);
  for (std::size_t c = 0; c < kChannels; ++c) {
    const double w = exit.weights[c] / kChannels;
    found_[c][ExitSums::kWeight] += w;
    found_[c][ExitSums::kDistance] += w * r;
    found_[c][ExitSums::kSquare] += w * r * r;
    if (static_cast<double>(exit.scatterings) > late_after_[c]) {
      sums_.channels[c].late[ExitSums::kWeight] += w;
      sums_.channels[c].late[ExitSums::kDistance] += w * r;
    }
  }
  return false;
}

void ExitTally::finish() {
  for (std::size_t c = 0; c < kChannels; ++c) {
    ExitSums::OfChannel& sums = sums_.channels[c];
    std::size_t product = 0;
    for (std::size_t i = 0; i < ExitSums::kScores; ++i) {
      sums.moments[i] += found_[c][i];
      for (std::size_t j = i; j < ExitSums::kScores; ++j) {
        sums.products[product++] += found_[c][i] * found_[c][j];
      }
    }
    found_[c].fill(0.0);
  }
}

}  // namespace lamina
