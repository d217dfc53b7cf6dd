// SPDX-License-Identifier: GPL-3.0-or-later
#include "dust/mesh.hpp"

#include <embree3/rtcore.h>

#include <atomic>
#include <limits>
#include <stdexcept>

namespace lamina {

namespace {

// Above this many triangles Embree uses compact nodes and indexed triangles: less memory, slower rays.
constexpr std::size_t kCompactTriangles = 3000000;

void keep_first_error(void* first, RTCError, const char* words) {
  auto& message = *static_cast<std::string*>(first);
  if (message.empty() && words != nullptr) {
    message = words;
  }
}

bool count_bytes(void* bytes, ssize_t change, bool) {
  *static_cast<std::atomic<ssize_t>*>(bytes) += change;
  return true;
}

bool ask_to_go_on(void* go_on, double fraction) {
  return (*static_cast<const std::function<bool(double)>*>(go_on))(fraction);
}

RTCRay embree_ray(const MeshRay& ray) {
  RTCRay result;
  result.org_x = ray.origin[0];
  result.org_y = ray.origin[1];
  result.org_z = ray.origin[2];
  result.tnear = ray.nearest;
  result.dir_x = ray.direction[0];
  result.dir_y = ray.direction[1];
  result.dir_z = ray.direction[2];
  result.time = 0.0F;
  result.tfar = ray.farthest;
  result.mask = ~0U;
  result.id = 0;
  result.flags = 0;
  return result;
}

}  // namespace

struct MeshScene::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::string error;
  std::atomic<ssize_t> bytes = 0;

  explicit Embree(unsigned threads) {
    device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (device == nullptr) {
      throw std::runtime_error("Embree does not start on this processor");
    }
    rtcSetDeviceErrorFunction(device, &keep_first_error, &error);
    rtcSetDeviceMemoryMonitorFunction(device, &count_bytes, &bytes);
    scene = rtcNewScene(device);
  }
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
};

MeshScene::MeshScene(std::vector<TrianglePart> parts, unsigned threads, const std::function<bool(double)>& go_on)
    : embree_(std::make_unique<Embree>(threads)), parts_(std::move(parts)) {
  std::size_t triangles = 0;
  for (TrianglePart& part : parts_) {
    triangles += part.triangles.size() / 3;
    const std::size_t vertices = part.vertices.size() / 3;
    part.vertices.push_back(0.0F);
    RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, part.vertices.data(), 0,
                               3 * sizeof(float), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, part.triangles.data(), 0,
                               3 * sizeof(std::uint32_t), part.triangles.size() / 3);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  const bool compact = triangles > kCompactTriangles;
  rtcSetSceneFlags(embree_->scene, compact ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_ROBUST);
  std::atomic<bool> stopped = false;
  const std::function<bool(double)> ask = [&](double fraction) {
    if (!go_on(fraction)) {
      stopped = true;
    }
    return !stopped;
  };
  rtcSetSceneProgressMonitorFunction(embree_->scene, &ask_to_go_on, const_cast<std::function<bool(double)>*>(&ask));
  rtcCommitScene(embree_->scene);
  rtcSetSceneProgressMonitorFunction(embree_->scene, nullptr, nullptr);
  if (stopped) {
    throw Stopped();
  }
  if (!embree_->error.empty()) {
    throw std::runtime_error("Embree cannot build the scene: " + embree_->error);
  }
}

MeshScene::~MeshScene() = default;

bool MeshScene::occluded(const MeshRay& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay traced = embree_ray(ray);
  rtcOccluded1(embree_->scene, &context, &traced);
  // Embree marks a hit by tfar = -infinity.
  return traced.tfar < 0.0F;
}

MeshHit MeshScene::first_hit(const MeshRay& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit traced;
  traced.ray = embree_ray(ray);
  traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  traced.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->scene, &context, &traced);
  if (traced.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return {-1, false};
  }
  const float along =
      traced.hit.Ng_x * ray.direction[0] + traced.hit.Ng_y * ray.direction[1] + traced.hit.Ng_z * ray.direction[2];
  return {static_cast<int>(traced.hit.geomID), along < 0.0F};
}

std::size_t MeshScene::bytes() const { return static_cast<std::size_t>(std::max<ssize_t>(0, embree_->bytes)); }

std::string mesh_self_test() {
  RTCDevice device = rtcNewDevice("threads=1");
  if (device == nullptr) {
    return "Embree does not start on this processor";
  }
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  rtcReleaseDevice(device);
  if (version != RTC_VERSION) {
    return "Embree has version " + std::to_string(version) + ", but version " + std::to_string(RTC_VERSION) +
           " is expected";
  }
  const MeshScene scene({{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}}}, 1, [](double) { return true; });
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const MeshRay hitting = {{0.25F, 0.25F, 1.0F}, {0.0F, 0.0F, -1.0F}, 0.0F, kFar};
  const MeshRay missing = {{0.75F, 0.75F, 1.0F}, {0.0F, 0.0F, -1.0F}, 0.0F, kFar};
  const MeshHit hit = scene.first_hit(hitting);
  if (!scene.occluded(hitting) || hit.part != 0 || !hit.front) {
    return "Embree does not find a triangle that a ray must hit";
  }
  if (scene.occluded(missing) || scene.first_hit(missing).part != -1) {
    return "Embree finds a triangle that a ray must miss";
  }
  return "";
}

}  // namespace lamina
