// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh_scene.hpp"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lamina {

namespace {

// Above this number of triangles Embree uses compact nodes and indexed triangles: less memory, slower rays.
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

/// The first hit of a ray with any part.
RTCRayHit intersection(RTCScene scene, const MeshRay& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit traced;
  traced.ray = embree_ray(ray);
  traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  traced.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context, &traced);
  return traced;
}

/// The point of a triangle nearest to p (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
Eigen::Vector3f nearest_on_triangle(const Eigen::Vector3f& p, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                                    const Eigen::Vector3f& c) {
  const Eigen::Vector3f ab = b - a;
  const Eigen::Vector3f ac = c - a;
  const float d1 = ab.dot(p - a);
  const float d2 = ac.dot(p - a);
  if (d1 <= 0.0F && d2 <= 0.0F) {
    return a;
  }
  const float d3 = ab.dot(p - b);
  const float d4 = ac.dot(p - b);
  if (d3 >= 0.0F && d4 <= d3) {
    return b;
  }
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0F && d1 >= 0.0F && d3 <= 0.0F) {
    return a + d1 / (d1 - d3) * ab;
  }
  const float d5 = ab.dot(p - c);
  const float d6 = ac.dot(p - c);
  if (d6 >= 0.0F && d5 <= d6) {
    return c;
  }
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0F && d2 >= 0.0F && d6 <= 0.0F) {
    return a + d2 / (d2 - d6) * ac;
  }
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0.0F && d4 - d3 >= 0.0F && d5 - d6 >= 0.0F) {
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

/// The corners of the face that a query has found.
std::array<Eigen::Vector3f, 3> corners_of(const std::vector<TrianglePart>& parts,
                                          const RTCPointQueryFunctionArguments& found) {
  const TrianglePart& part = parts[found.geomID];
  const auto corner = [&](std::size_t k) {
    return Eigen::Vector3f(part.vertices.data() + std::size_t{3} * part.triangles[3 * std::size_t{found.primID} + k]);
  };
  return {corner(0), corner(1), corner(2)};
}

float distance_to(const std::array<Eigen::Vector3f, 3>& face, const RTCPointQuery& query) {
  const Eigen::Vector3f place(query.x, query.y, query.z);
  return (nearest_on_triangle(place, face[0], face[1], face[2]) - place).norm();
}

/// State of a query for the nearest face: the parts, and the shortest distance found so far.
struct NearestSearch {
  const std::vector<TrianglePart>& parts;
  float distance;
};

bool take_nearer_face(RTCPointQueryFunctionArguments* found) {
  auto& search = *static_cast<NearestSearch*>(found->userPtr);
  const float distance = distance_to(corners_of(search.parts, *found), *found->query);
  if (!(distance < search.distance)) {
    return false;
  }
  search.distance = distance;
  found->query->radius = distance;
  return true;
}

/// State of a query for the face whose normal is closest to a direction: the parts, and the largest cosine so far.
struct AlignedSearch {
  const std::vector<TrianglePart>& parts;
  Eigen::Vector3f direction;
  std::optional<float> cosine;
};

bool take_more_aligned_face(RTCPointQueryFunctionArguments* found) {
  auto& search = *static_cast<AlignedSearch*>(found->userPtr);
  const auto face = corners_of(search.parts, *found);
  const Eigen::Vector3f normal = (face[1] - face[0]).cross(face[2] - face[0]);
  if (normal.norm() > 0.0F && distance_to(face, *found->query) <= found->query->radius) {
    search.cosine = std::max(search.cosine.value_or(-1.0F), normal.dot(search.direction) / normal.norm());
  }
  return false;  // the radius of the query stays
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
  const RTCRayHit traced = intersection(embree_->scene, ray);
  if (traced.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return {-1, false};
  }
  const float along =
      traced.hit.Ng_x * ray.direction[0] + traced.hit.Ng_y * ray.direction[1] + traced.hit.Ng_z * ray.direction[2];
  return {static_cast<int>(traced.hit.geomID), along < 0.0F};
}

std::optional<SurfaceHit> MeshScene::first_surface(const MeshRay& ray) const {
  const RTCRayHit traced = intersection(embree_->scene, ray);
  if (traced.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return std::nullopt;
  }
  const float x = traced.hit.Ng_x;
  const float y = traced.hit.Ng_y;
  const float z = traced.hit.Ng_z;
  const float scale = 1.0F / std::sqrt(x * x + y * y + z * z);
  return SurfaceHit{traced.ray.tfar, {scale * x, scale * y, scale * z}, traced.hit.primID};
}

float MeshScene::nearest_distance(const float place[3], float within) const {
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query = {place[0], place[1], place[2], 0.0F, within};
  NearestSearch search{parts_, within};
  rtcPointQuery(embree_->scene, &query, &context, &take_nearer_face, &search);
  return search.distance;
}

std::optional<float> MeshScene::largest_cosine(const float place[3], const float direction[3], float within) const {
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query = {place[0], place[1], place[2], 0.0F, within};
  AlignedSearch search{parts_, Eigen::Vector3f(direction), std::nullopt};
  rtcPointQuery(embree_->scene, &query, &context, &take_more_aligned_face, &search);
  return search.cosine;
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
