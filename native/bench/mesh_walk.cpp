// SPDX-License-Identifier: GPL-3.0-or-later
// Measures collisions per second of CPU time for walks in a mesh of 100,352 faces. Each of the 256^3 voxels holds the
// coefficients of three channels. Prints one line of JSON for each case and number of threads.
//     bench_mesh_walk [WALKS OF A POINT [THREADS ...]]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <vector>

#include "mesh_walk/point_walks.hpp"

namespace {

using namespace lamina;
using std::numbers::pi;

constexpr int kSide = 256;        // voxels
constexpr double kRadius = 10.0;  // mm

/// A ball with bumps.
TrianglePart bumpy_ball() {
  constexpr std::uint32_t kRings = 224;
  constexpr std::uint32_t kAround = 224;
  TrianglePart part;
  for (std::uint32_t i = 0; i <= kRings; ++i) {
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const double theta = pi * i / kRings;
      const double phi = 2.0 * pi * j / kAround;
      const double radius = kRadius * (0.9 + 0.1 * std::sin(5.0 * theta) * std::sin(theta) * std::cos(7.0 * phi));
      part.vertices.push_back(static_cast<float>(radius * std::sin(theta) * std::cos(phi)));
      part.vertices.push_back(static_cast<float>(radius * std::sin(theta) * std::sin(phi)));
      part.vertices.push_back(static_cast<float>(radius * std::cos(theta)));
    }
  }
  for (std::uint32_t i = 0; i < kRings; ++i) {
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const std::uint32_t a = i * kAround + j;
      const std::uint32_t b = i * kAround + (j + 1) % kAround;
      for (const std::uint32_t corner : {a, a + kAround, b, b, a + kAround, b + kAround}) {
        part.triangles.push_back(corner);
      }
    }
  }
  return part;
}

/// Converts to a half, rounding down. Values below the smallest normal half are not supported.
std::uint16_t half(double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value) * 0x1.0p-112F);
  return static_cast<std::uint16_t>(bits >> 13U);
}

/// White stone with dark veins.
std::vector<std::uint16_t> veined() {
  std::vector<std::uint16_t> voxels;
  voxels.reserve(std::size_t{6} * kSide * kSide * kSide);
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      for (int z = 0; z < kSide; ++z) {
        const double wave = std::sin(0.11 * x + 2.0 * std::sin(0.07 * y) + 1.5 * std::sin(0.05 * z));
        const double vein = std::exp(-20.0 * wave * wave);
        for (const double white : {2.19, 2.62, 3.0}) {
          voxels.push_back(half(white * (1.0 - 0.3 * vein)));
        }
        for (const double white : {0.0021, 0.0041, 0.0071}) {
          voxels.push_back(half(white + 0.06 * vein));
        }
      }
    }
  }
  return voxels;
}

std::vector<MeshWalk::Start> starts_of(const TrianglePart& part, std::size_t count) {
  std::vector<MeshWalk::Start> starts;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t* corners = part.triangles.data() + 3 * (k * (part.triangles.size() / 3) / count);
    const auto corner = [&](int c, int axis) {
      return static_cast<double>(part.vertices[3 * corners[c] + static_cast<std::uint32_t>(axis)]);
    };
    Place mean;
    double* const means[] = {&mean.x, &mean.y, &mean.z};
    double edges[2][3];
    for (int axis = 0; axis < 3; ++axis) {
      *means[axis] = (corner(0, axis) + corner(1, axis) + corner(2, axis)) / 3.0;
      edges[0][axis] = corner(1, axis) - corner(0, axis);
      edges[1][axis] = corner(2, axis) - corner(0, axis);
    }
    const Ray cross{edges[0][1] * edges[1][2] - edges[0][2] * edges[1][1],
                    edges[0][2] * edges[1][0] - edges[0][0] * edges[1][2],
                    edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0]};
    if (cross.dot(cross) > 0.0) {
      starts.push_back({mean, normalised(cross), std::nullopt});
    }
  }
  return starts;
}

/// CPU time of all threads of this process.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int count, char** words) {
  const auto walks = static_cast<std::uint32_t>(count > 1 ? std::atoi(words[1]) : 32);
  std::vector<unsigned> threads;
  for (int k = 2; k < count; ++k) {
    threads.push_back(static_cast<unsigned>(std::atoi(words[k])));
  }
  const TrianglePart part = bumpy_ball();
  const std::vector<std::uint16_t> voxels = veined();
  const GridFrame frame{{kSide, kSide, kSide}, {-kRadius, -kRadius, -kRadius}, {kRadius, kRadius, kRadius}, true};
  const CoefficientGrid grid = CoefficientGrid::of_halves(frame, voxels.data(), 0.0F);
  struct Case {
    const char* name;
    SurfaceBoundary boundary;
  };
  const Facets rough{0.3};
  const Case cases[] = {{"matched", {1.0, nullptr}}, {"smooth, 1.5", {1.5, nullptr}}, {"rough, 1.5", {1.5, &rough}}};
  for (const unsigned number : threads.empty() ? std::vector<unsigned>{1, 0} : threads) {
    ThreadPool pool(number);
    const double building = cpu_seconds();
    const Solid solid(part, {}, pool, [](double) { return true; });
    const double built = cpu_seconds() - building;
    const WalkPoints points{starts_of(part, 2000), 0, 0, walks, 1};
    for (const Case& one : cases) {
      const MeshWalk walk(solid, grid, one.boundary);
      const double start = cpu_seconds();
      WalkCounts total;
      for (const ExitResult& result : walk_to_exits(walk, points, pool)) {
        total.add(result.counts);
      }
      const double seconds = cpu_seconds() - start;
      std::printf(
          "{\"name\": \"%s, %u threads\", \"Mcollisions/CPU-s\": %.3f, \"collisions a walk\": %.1f, "
          "\"rays a collision\": %.3f, \"lost\": %.2g, \"build CPU-s\": %.2f}\n",
          one.name, pool.threads(), static_cast<double>(total.collisions) / seconds * 1e-6,
          static_cast<double>(total.collisions) / static_cast<double>(points.starts.size() * points.walks),
          static_cast<double>(total.rays) / static_cast<double>(total.collisions),
          total.lost / static_cast<double>(points.starts.size() * points.walks), built);
    }
  }
  return 0;
}
