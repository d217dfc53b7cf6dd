// SPDX-License-Identifier: GPL-3.0-or-later
#include "interior/coefficient_grid.hpp"

#include <algorithm>
#include <utility>

namespace lamina {

namespace {

// Majorants are raised by this factor. The margin exceeds the rounding error of sums in single precision.
constexpr float kAbove = 1.0F + 0x1p-20F;
// Extinctions of this ratio count as equal.
constexpr float kEqual = 0.995F;

}  // namespace

CoefficientGrid CoefficientGrid::of_halves(const GridFrame& frame, const std::uint16_t* voxels, float g) {
  return {frame, voxels, {}, g};
}

CoefficientGrid CoefficientGrid::of_mixture(const GridFrame& frame, const std::uint16_t* voxels,
                                            std::vector<EndMaterial> palette) {
  if (palette.size() == 1) {
    palette.push_back(palette.front());
  }
  return {frame, voxels, std::move(palette), 0.0F};
}

CoefficientGrid::CoefficientGrid(const GridFrame& frame, const std::uint16_t* voxels, std::vector<EndMaterial> palette,
                                 float g)
    : voxels_(frame.voxels),
      low_(frame.low),
      smooth_(frame.smooth),
      data_(voxels),
      palette_(std::move(palette)),
      g_(g) {
  if (!palette_.empty()) {
    palette_step_ = static_cast<float>(palette_.size() - 1) / 65535.0F;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    per_mm_[axis] = voxels_[axis] / (frame.high[axis] - frame.low[axis]);
    bricks_[axis] = (voxels_[axis] + kBrick - 1) / kBrick;
    bricks_per_mm_[axis] = per_mm_[axis] / kBrick;
  }
  find_majorants();
}

void CoefficientGrid::find_majorants() {
  const auto count = [](const std::array<int, 3>& sizes) {
    return static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]) * static_cast<std::size_t>(sizes[2]);
  };
  majorants_.assign(count(bricks_), {});
  // Take the maximum over all voxels that a sample inside the brick can read. A smooth grid also reads neighbours.
  const int margin = smooth_ ? 1 : 0;
  std::array<std::size_t, 3> first;
  std::array<std::size_t, 3> last;
  std::size_t index = 0;
  const auto bricks_at = [&](std::size_t axis, int voxel) {
    first[axis] = static_cast<std::size_t>(std::max(0, voxel - margin) / kBrick);
    last[axis] = static_cast<std::size_t>(std::min(voxels_[axis] - 1, voxel + margin) / kBrick);
  };
  for (int x = 0; x < voxels_[0]; ++x) {
    bricks_at(0, x);
    for (int y = 0; y < voxels_[1]; ++y) {
      bricks_at(1, y);
      for (int z = 0; z < voxels_[2]; ++z) {
        bricks_at(2, z);
        const Sample sample = voxel(index++);
        const float largest_extinction = largest_of(sample.extinction);
        is_grey_ = is_grey_ && sample.g_first == sample.g_second &&
                   *std::min_element(sample.extinction.begin(), sample.extinction.end()) >= kEqual * largest_extinction;
        Majorants own;
        for (std::size_t c = 0; c < kChannels; ++c) {
          own[c] = kAbove * sample.extinction[c];
        }
        own[kChannels] = kAbove * largest_extinction;
        for (std::size_t i = first[0]; i <= last[0]; ++i) {
          for (std::size_t j = first[1]; j <= last[1]; ++j) {
            for (std::size_t k = first[2]; k <= last[2]; ++k) {
              Majorants& largest =
                  majorants_[(i * static_cast<std::size_t>(bricks_[1]) + j) * static_cast<std::size_t>(bricks_[2]) + k];
              for (std::size_t c = 0; c < own.size(); ++c) {
                largest[c] = std::max(largest[c], own[c]);
              }
            }
          }
        }
      }
    }
  }
}

}  // namespace lamina
