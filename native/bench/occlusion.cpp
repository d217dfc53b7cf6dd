// SPDX-License-Identifier: GPL-3.0-or-later
// Measures rays of settling dust against a bare Embree loop over precomputed rays of the same distribution, alternating
// in the same run, on the same scene and number of threads. Prints one line of JSON.
//     bench_occlusion FILE SPREAD THREADS      FILE: counts of vertices, triangles, points (u64), then x y z of the
//                                              vertices, indices, x y z of points and of normals (f32, u32, f32, f32)
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <numbers>
#include <vector>

#include "dust/dust.hpp"
#include "numeric/rng.hpp"

namespace {

using namespace lamina;

constexpr int kRaysPerPoint = 256;
constexpr float kOffset = 0x1p-17F;
constexpr int kRounds = 7;

struct Scene {
  TrianglePart part;
  std::vector<float> positions, normals;
};

template <typename T>
std::vector<T> read(std::ifstream& file, std::size_t count) {
  std::vector<T> values(count);
  file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
  return values;
}

Scene load(const char* path) {
  std::ifstream file(path, std::ios::binary);
  const auto counts = read<std::uint64_t>(file, 3);
  Scene scene;
  scene.part.vertices = read<float>(file, 3 * counts[0]);
  scene.part.triangles = read<std::uint32_t>(file, 3 * counts[1]);
  scene.positions = read<float>(file, 3 * counts[2]);
  scene.normals = read<float>(file, 3 * counts[2]);
  if (!file) {
    std::fprintf(stderr, "%s: is not a complete input file of this benchmark\n", path);
    std::exit(1);
  }
  return scene;
}

/// The rays that settling traces: for each azimuth in turn, the rays of the cone that leave the face.
std::vector<RTCRay> ready_rays(const Scene& scene, float sin_spread) {
  std::vector<RTCRay> rays;
  for (std::size_t i = 0; i < scene.positions.size() / 3; ++i) {
    const float* p = scene.positions.data() + 3 * i;
    const float* n = scene.normals.data() + 3 * i;
    Rng rng(1, i);
    const double turn = rng.uniform();
    const double shift = rng.uniform();
    for (int k = 0; k < kRaysPerPoint; ++k) {
      const double azimuth = 2.0 * std::numbers::pi * ((k + 0.5) / kRaysPerPoint + turn);
      const double sine2 = sin_spread * sin_spread * std::fmod(k * std::numbers::phi + shift, 1.0);
      const double slope = std::sqrt(sine2 / (1.0 - sine2));
      RTCRay ray = {};
      ray.dir_x = static_cast<float>(slope * std::cos(azimuth));
      ray.dir_y = static_cast<float>(slope * std::sin(azimuth));
      ray.dir_z = 1.0F;
      if (n[0] * ray.dir_x + n[1] * ray.dir_y + n[2] * ray.dir_z <= 0.0F) {
        continue;
      }
      ray.org_x = p[0] + kOffset * n[0];
      ray.org_y = p[1] + kOffset * n[1];
      ray.org_z = p[2] + kOffset * n[2];
      ray.tfar = std::numeric_limits<float>::infinity();
      ray.mask = ~0U;
      rays.push_back(ray);
    }
  }
  return rays;
}

RTCScene bare_scene(RTCDevice device, TrianglePart& part) {
  const std::size_t vertices = part.vertices.size() / 3;
  part.vertices.push_back(0.0F);
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, part.vertices.data(), 0, 12,
                             vertices);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, part.triangles.data(), 0, 12,
                             part.triangles.size() / 3);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(scene);
  return scene;
}

std::uint64_t bare_loop(RTCScene scene, const std::vector<RTCRay>& rays, ThreadPool& pool) {
  constexpr std::size_t kBlock = 8192;
  std::atomic<std::uint64_t> hits = 0;
  pool.run((rays.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    std::uint64_t found = 0;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const std::size_t last = std::min(rays.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < last; ++i) {
      RTCRay ray = rays[i];
      rtcOccluded1(scene, &context, &ray);
      found += ray.tfar < 0.0F ? 1 : 0;
    }
    hits += found;
  });
  return hits;
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fprintf(stderr, "usage: bench_occlusion FILE SPREAD THREADS\n");
    return 2;
  }
  Scene loaded = load(words[1]);
  const auto sin_spread = static_cast<float>(std::sin(std::atof(words[2])));
  ThreadPool pool(static_cast<unsigned>(std::atoi(words[3])));
  RTCDevice device = rtcNewDevice(("threads=" + std::to_string(pool.threads())).c_str());
  TrianglePart part = loaded.part;
  RTCScene bare = bare_scene(device, part);
  const MeshScene scene({loaded.part}, pool.threads(), [](double) { return true; });
  const std::vector<RTCRay> rays = ready_rays(loaded, sin_spread);
  const Fall fall = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 0.0F, 0.0F, sin_spread};
  const OpenShare open(fall);
  const PointSet points = {loaded.positions.data(), loaded.normals.data(), loaded.positions.size() / 3, 0};
  std::vector<float> shares(points.count);
  std::vector<double> bare_rates;
  std::vector<double> dust_rates;
  std::uint64_t hits = 0;
  for (int round = 0; round < kRounds; ++round) {
    bare_rates.push_back(static_cast<double>(rays.size()) / seconds_of([&] { hits = bare_loop(bare, rays, pool); }));
    std::uint64_t traced = 0;
    const double seconds = seconds_of([&] {
      traced = dust_arrivals(scene, fall, open, points, {kRaysPerPoint, 1, false, kOffset}, shares.data(), pool);
    });
    dust_rates.push_back(static_cast<double>(traced) / seconds);
  }
  std::printf("{\"rays\": %zu, \"hit\": %.4f, \"bare\": %.4g, \"dust\": %.4g, \"ratio\": %.3f}\n", rays.size(),
              static_cast<double>(hits) / static_cast<double>(rays.size()), median(bare_rates), median(dust_rates),
              median(dust_rates) / median(bare_rates));
  rtcReleaseScene(bare);
  rtcReleaseDevice(device);
  return 0;
}
