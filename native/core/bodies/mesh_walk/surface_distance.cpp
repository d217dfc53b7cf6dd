// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_walk/surface_distance.hpp"

#include <algorithm>
#include <atomic>
#include <limits>

namespace lamina {

namespace {

constexpr double kCells = 1 << 18;         // approximate number of cells
constexpr double kRounding = 1e-6;         // error of distances in single precision, relative to the size of the box
constexpr float kNear = 3.0F;              // cells
constexpr float kHalfDiagonal = 0.86603F;  // of a cell, rounded up
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Replaces each value f(i) of a line by the least f(j) + (i - j)^2: the lower envelope of parabolas.
class ParabolaEnvelope {
 public:
  explicit ParabolaEnvelope(std::size_t longest) : line_(longest), vertex_(longest), from_(longest + 1) {}

  void apply(float* values, std::size_t count, std::size_t stride) {
    std::size_t parabolas = 0;
    for (std::size_t i = 0; i < count; ++i) {
      line_[i] = values[i * stride];
      if (line_[i] == kInfinity) {
        continue;
      }
      double start = -std::numeric_limits<double>::infinity();
      while (parabolas > 0 && (start = meeting(vertex_[parabolas - 1], i)) <= from_[parabolas - 1]) {
        --parabolas;
      }
      if (parabolas == 0) {
        start = -std::numeric_limits<double>::infinity();
      }
      vertex_[parabolas] = i;
      from_[parabolas++] = start;
    }
    if (parabolas == 0) {
      return;
    }
    from_[parabolas] = std::numeric_limits<double>::infinity();
    std::size_t k = 0;
    for (std::size_t i = 0; i < count; ++i) {
      while (from_[k + 1] < static_cast<double>(i)) {
        ++k;
      }
      const double off = static_cast<double>(i) - static_cast<double>(vertex_[k]);
      values[i * stride] = static_cast<float>(off * off + static_cast<double>(line_[vertex_[k]]));
    }
  }

 private:
  /// The abscissa at which the parabolas of two vertices, the second to the right, intersect.
  double meeting(std::size_t left, std::size_t right) const {
    const auto a = static_cast<double>(left);
    const auto b = static_cast<double>(right);
    return 0.5 * ((static_cast<double>(line_[right]) + b * b) - (static_cast<double>(line_[left]) + a * a)) / (b - a);
  }

  std::vector<float> line_;
  std::vector<std::size_t> vertex_;
  std::vector<double> from_;
};

}  // namespace

SurfaceDistance::SurfaceDistance(const MeshScene& scene, const std::array<double, 3>& low,
                                 const std::array<double, 3>& sides, ThreadPool& pool,
                                 const std::function<bool(double)>& go_on)
    : low_(low), cell_(std::cbrt(sides[0] * sides[1] * sides[2] / kCells)), per_mm_(1.0 / cell_) {
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells_[axis] = static_cast<int>(std::ceil(sides[axis] * per_mm_));
    count *= static_cast<std::size_t>(cells_[axis]);
  }
  distances_.resize(count);
  measure_near(scene, kRounding * std::hypot(sides[0], sides[1], sides[2]) * per_mm_, pool, go_on);
  fill_far(pool);
}

void SurfaceDistance::measure_near(const MeshScene& scene, double rounding, ThreadPool& pool,
                                   const std::function<bool(double)>& go_on) {
  const auto [nx, ny, nz] = cells_;
  std::atomic<int> done = 0;
  std::atomic<bool> stopped = false;
  pool.run(static_cast<std::size_t>(nx), [&, ny = ny, nz = nz, nx = nx](std::size_t x) {
    if (stopped) {
      return;
    }
    float* out = distances_.data() + x * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz);
    for (int y = 0; y < ny; ++y) {
      for (int z = 0; z < nz; ++z) {
        const float centre[3] = {static_cast<float>(low_[0] + (static_cast<double>(x) + 0.5) * cell_),
                                 static_cast<float>(low_[1] + (y + 0.5) * cell_),
                                 static_cast<float>(low_[2] + (z + 0.5) * cell_)};
        const double found = scene.nearest_distance(centre, kNear * static_cast<float>(cell_)) * per_mm_;
        *out++ = static_cast<float>(std::max(0.0, found - rounding));
      }
    }
    if (!go_on(static_cast<double>(++done) / nx)) {
      stopped = true;
    }
  });
  if (stopped) {
    throw MeshScene::Stopped();
  }
}

void SurfaceDistance::fill_far(ThreadPool& pool) {
  // The nearest surface point is at most half a cell diagonal away from the centre of its cell.
  std::vector<float> squares(distances_.size());
  std::transform(distances_.begin(), distances_.end(), squares.begin(),
                 [](float distance) { return distance <= kHalfDiagonal ? 0.0F : kInfinity; });
  const std::array<std::size_t, 3> counts = {static_cast<std::size_t>(cells_[0]), static_cast<std::size_t>(cells_[1]),
                                             static_cast<std::size_t>(cells_[2])};
  const std::array<std::size_t, 3> strides = {counts[1] * counts[2], counts[2], 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t outer = axis == 0 ? 1 : 0;
    const std::size_t inner = axis == 2 ? 1 : 2;
    pool.run(counts[outer], [&](std::size_t i) {
      ParabolaEnvelope envelope(counts[axis]);
      for (std::size_t j = 0; j < counts[inner]; ++j) {
        envelope.apply(squares.data() + i * strides[outer] + j * strides[inner], counts[axis], strides[axis]);
      }
    });
  }
  for (std::size_t k = 0; k < distances_.size(); ++k) {
    // The factor covers the rounding error of distances of thousands of cells in single precision.
    const float far = std::sqrt(squares[k]) * (1.0F - 1e-6F) - kHalfDiagonal;
    distances_[k] = std::max(distances_[k], far);
  }
}

}  // namespace lamina
