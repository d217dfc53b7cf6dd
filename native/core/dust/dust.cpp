// SPDX-License-Identifier: GPL-3.0-or-later
#include "dust/dust.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "dust/disc_pattern.hpp"
#include "numeric/rng.hpp"
#include "numeric/tangents.hpp"

namespace lamina {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Small enough that threads finish together, large enough to amortise the set-up of a task.
constexpr std::size_t kPointsPerTask = 32;
constexpr std::size_t kBatch = 256;  // rays whose pattern is turned at once
// With this number of rays or more, and if the rays of the first part are all open or all occluded, the other parts are
// traced at one of kRoulette points only, and count that many times there (Russian roulette): the mean stays.
constexpr std::size_t kManyRays = 128;
constexpr float kRoulette = 4.0F;
constexpr std::uint64_t kGrainsPerTask = 8192;
// Start of each ray, relative to the offset. A point may lie in the plane of a neighbouring face, for example at the
// foot of a wall, and that face must not occlude it. The face that the point was offset from is farther than this.
constexpr float kNearest = 0.25F;

float dot(const Vec3f& a, const Vec3f& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The slope tan(theta) of a fall, where sin^2(theta) = sin^2(spread) * square.
float slope_of(float sin_spread, float square) {
  const float sine2 = sin_spread * sin_spread * square;
  return std::sqrt(sine2 / (1.0F - sine2));
}

float offset_at(const Vec3f& position, float relative) {
  return relative * std::max({1.0F, std::abs(position[0]), std::abs(position[1]), std::abs(position[2])});
}

/// Sums for one side of a point's plane.
struct SideSums {
  double open = 0.0;
  double all = 0.0;

  double share() const { return all > 0.0 ? open / all : 0.0; }
  bool agrees() const { return open == 0.0 || open == all; }
};

class ArrivalAtPoint {
 public:
  ArrivalAtPoint(const MeshScene& scene, const Fall& fall, const OpenShare& open, const ArrivalOptions& options)
      : scene_(scene),
        fall_(fall),
        open_(open),
        options_(options),
        pattern_(fall.sin_spread > 0.0F ? options.rays : 1) {}

  /// The shares of the front (the side that the normal points to) and of the back, 0 unless two_sided.
  std::array<float, 2> shares(const Vec3f& position, const Vec3f& normal, std::uint64_t number,
                              std::uint64_t& rays) const {
    const float up = dot(normal, fall_.up);
    const float n1 = dot(normal, fall_.across1);
    const float n2 = dot(normal, fall_.across2);
    const double front = open_(up, n1, n2);
    const double back = options_.two_sided ? open_(-up, -n1, -n2) : 0.0;
    if (front <= 0.0 && back <= 0.0) {
      return {0.0F, 0.0F};
    }
    const DiscTurn turn(options_.seed, number);
    Sums sums;
    const auto shares = [&]() -> std::array<double, 2> { return {front * sums[0].share(), back * sums[1].share()}; };
    std::size_t done = 0;
    if (pattern_.size() >= kManyRays) {
      done = (pattern_.size() + DiscPattern::kParts - 1) / DiscPattern::kParts;
      trace(position, normal, turn, 0, done, sums, rays);
      if (sums[0].agrees() && sums[1].agrees()) {
        const std::array<double, 2> early = shares();
        if (turn.chance * kRoulette >= 1.0F) {
          return {static_cast<float>(early[0]), static_cast<float>(early[1])};
        }
        trace(position, normal, turn, done, pattern_.size(), sums, rays);
        const std::array<double, 2> late = shares();
        return {static_cast<float>(early[0] + kRoulette * (late[0] - early[0])),
                static_cast<float>(early[1] + kRoulette * (late[1] - early[1]))};
      }
    }
    trace(position, normal, turn, done, pattern_.size(), sums, rays);
    if (pattern_.size() == 1) {
      // With one ray the ratio of the sums is biased; the ray's weight times its visibility is not.
      return {static_cast<float>(sums[0].open), static_cast<float>(sums[1].open)};
    }
    const std::array<double, 2> all = shares();
    return {static_cast<float>(all[0]), static_cast<float>(all[1])};
  }

 private:
  using Sums = std::array<SideSums, 2>;

  /// The rays [begin, end) of the pattern.
  void trace(const Vec3f& position, const Vec3f& normal, const DiscTurn& turn, std::size_t begin, std::size_t end,
             Sums& sums, std::uint64_t& rays) const {
    const float up = dot(normal, fall_.up);
    const float n1 = dot(normal, fall_.across1);
    const float n2 = dot(normal, fall_.across2);
    const float offset = offset_at(position, options_.offset);
    float x[kBatch];
    float y[kBatch];
    float square[kBatch];
    for (std::size_t first = begin; first < end; first += kBatch) {
      const std::size_t count = std::min(kBatch, end - first);
      turned(pattern_, turn, first, count, x, y, square);
      for (std::size_t i = 0; i < count; ++i) {
        const float slope = slope_of(fall_.sin_spread, square[i]);
        const float t1 = slope * x[i] - fall_.wind1;
        const float t2 = slope * y[i] - fall_.wind2;
        const float weight = up + n1 * t1 + n2 * t2;
        if (weight == 0.0F || (weight < 0.0F && !options_.two_sided)) {
          continue;
        }
        const float off = weight > 0.0F ? offset : -offset;
        MeshRay ray;
        for (std::size_t k = 0; k < 3; ++k) {
          ray.origin[k] = position[k] + off * normal[k];
          ray.direction[k] = fall_.up[k] + t1 * fall_.across1[k] + t2 * fall_.across2[k];
        }
        ray.nearest = kNearest * offset / std::sqrt(1.0F + t1 * t1 + t2 * t2);
        ray.farthest = kInfinity;
        ++rays;
        SideSums& side = sums[weight > 0.0F ? 0 : 1];
        side.all += std::abs(weight);
        if (!scene_.occluded(ray)) {
          side.open += std::abs(weight);
        }
      }
    }
  }

  const MeshScene& scene_;
  const Fall& fall_;
  const OpenShare& open_;
  const ArrivalOptions& options_;
  DiscPattern pattern_;
};

/// Calls work(position, normal, number, index, rays) for all points. Returns the sum of `rays`.
std::uint64_t for_points(const PointSet& points, ThreadPool& pool, const auto& work) {
  std::atomic<std::uint64_t> all_rays = 0;
  pool.run((points.count + kPointsPerTask - 1) / kPointsPerTask, [&](std::size_t task) {
    std::uint64_t rays = 0;
    const std::size_t last = std::min(points.count, (task + 1) * kPointsPerTask);
    for (std::size_t i = task * kPointsPerTask; i < last; ++i) {
      const float* p = points.positions + 3 * i;
      const float* n = points.normals + 3 * i;
      work(Vec3f{p[0], p[1], p[2]}, Vec3f{n[0], n[1], n[2]}, points.first_number + i, i, rays);
    }
    all_rays += rays;
  });
  return all_rays;
}

/// Calls take(ray) for the rays of a point into the hemisphere around `normal`, distributed by the cosine. They start
/// `offset` along it, are of length 1, and end at `reach`.
void for_hemisphere(const DiscPattern& pattern, const DiscTurn& turn, const Vec3f& position, const Vec3f& normal,
                    float offset, float reach, const auto& take) {
  const auto [a, b] = tangents_of(normal[0], normal[1], normal[2]);
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    float x = 0.0F;
    float y = 0.0F;
    float square = 0.0F;
    turned(pattern, turn, i, 1, &x, &y, &square);
    const float sine = std::sqrt(square);
    const float cosine = std::sqrt(1.0F - square);
    MeshRay ray;
    for (std::size_t k = 0; k < 3; ++k) {
      ray.origin[k] = position[k] + offset * normal[k];
      ray.direction[k] = sine * (x * a[k] + y * b[k]) + cosine * normal[k];
    }
    ray.nearest = kNearest * offset;
    ray.farthest = reach;
    take(ray);
  }
}

/// How much a face that a ray leaves a body through, with the normal `other`, is the other side of an edge of the face
/// with `normal`: 1 up to the angle of an edge of 60 degrees, 0 for the opposite side of a sheet.
float is_beside(const Vec3f& normal, const Vec3f& other) { return std::min(1.0F, 2.0F * (1.0F + dot(normal, other))); }

bool is_zero(const Vec3f& v) { return v[0] == 0.0F && v[1] == 0.0F && v[2] == 0.0F; }

}  // namespace

OpenShare::OpenShare(const Fall& fall)
    : wind1_(fall.wind1),
      wind2_(fall.wind2),
      spread_(std::asin(static_cast<double>(fall.sin_spread))),
      table_(kIntervals + 1, 0.0) {
  if (spread_ <= 0.0) {
    return;
  }
  // The mean over phi of max(0, c + b tan(theta) cos(phi)) has a closed form. The mean over theta, with the density
  // 2 sin cos / sin^2(spread), is a midpoint sum.
  constexpr int kThetas = 512;
  for (int k = 0; k <= kIntervals; ++k) {
    const double angle = spread_ * (2.0 * k / kIntervals - 1.0);
    const double c = std::sin(angle);
    double sum = 0.0;
    double density = 0.0;
    for (int j = 0; j < kThetas; ++j) {
      const double theta = spread_ * (j + 0.5) / kThetas;
      const double weight = std::sin(theta) * std::cos(theta);
      const double swing = std::cos(angle) * std::tan(theta);
      double mean = std::max(c, 0.0);
      if (std::abs(c) < swing) {
        mean = (c * std::acos(-c / swing) + std::sqrt(swing * swing - c * c)) / kPi;
      }
      sum += weight * mean;
      density += weight;
    }
    table_[static_cast<std::size_t>(k)] = sum / density;
  }
}

double OpenShare::operator()(double up, double across1, double across2) const {
  const double c = up - across1 * wind1_ - across2 * wind2_;
  const double b = std::hypot(across1, across2);
  const double angle = std::atan2(c, b);
  if (angle >= spread_) {
    return std::max(c, 0.0);
  }
  if (angle <= -spread_) {
    return 0.0;
  }
  const double place = (angle / spread_ + 1.0) * 0.5 * kIntervals;
  const auto below = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(kIntervals - 1));
  const double between = place - static_cast<double>(below);
  return std::hypot(b, c) * (table_[below] * (1.0 - between) + table_[below + 1] * between);
}

std::uint64_t dust_arrivals(const MeshScene& scene, const Fall& fall, const OpenShare& open, const PointSet& points,
                            const ArrivalOptions& options, float* shares, ThreadPool& pool) {
  const ArrivalAtPoint arrival(scene, fall, open, options);
  return for_points(
      points, pool,
      [&](const Vec3f& position, const Vec3f& normal, std::uint64_t number, std::size_t index, std::uint64_t& rays) {
        const std::array<float, 2> sides =
            is_zero(normal) ? std::array{0.0F, 0.0F} : arrival.shares(position, normal, number, rays);
        if (options.two_sided) {
          shares[2 * index] = sides[0];
          shares[2 * index + 1] = sides[1];
        } else {
          shares[index] = sides[0];
        }
      });
}

std::uint64_t dust_exposures(const MeshScene& scene, const PointSet& points, const ArrivalOptions& options, float reach,
                             float* exposures, ThreadPool& pool) {
  const DiscPattern pattern(options.rays);
  return for_points(
      points, pool,
      [&](const Vec3f& position, const Vec3f& normal, std::uint64_t number, std::size_t index, std::uint64_t& rays) {
        if (is_zero(normal)) {
          exposures[index] = 1.0F;
          return;
        }
        const DiscTurn turn(options.seed, number);
        std::size_t open = 0;
        for_hemisphere(pattern, turn, position, normal, offset_at(position, options.offset), reach,
                       [&](const MeshRay& ray) { open += scene.occluded(ray) ? 0 : 1; });
        rays += pattern.size();
        exposures[index] = static_cast<float>(open) / static_cast<float>(pattern.size());
      });
}

std::uint64_t dust_convexities(const MeshScene& scene, const PointSet& points, const ArrivalOptions& options,
                               float reach, float* convexities, ThreadPool& pool) {
  const DiscPattern pattern(options.rays);
  return for_points(
      points, pool,
      [&](const Vec3f& position, const Vec3f& normal, std::uint64_t number, std::size_t index, std::uint64_t& rays) {
        convexities[index] = 0.0F;
        if (is_zero(normal)) {
          return;
        }
        const Vec3f inward{-normal[0], -normal[1], -normal[2]};
        const DiscTurn turn(options.seed, number);
        double sum = 0.0;
        for_hemisphere(pattern, turn, position, inward, offset_at(position, options.offset), reach,
                       [&](const MeshRay& ray) {
                         const std::optional<SurfaceHit> hit = scene.first_surface(ray);
                         if (!hit) {
                           return;
                         }
                         Vec3f other{hit->normal[0], hit->normal[1], hit->normal[2]};
                         const bool leaves = dot(other, {ray.direction[0], ray.direction[1], ray.direction[2]}) > 0.0F;
                         if (!leaves && options.two_sided) {
                           other = {-other[0], -other[1], -other[2]};
                         }
                         if (leaves || options.two_sided) {
                           sum += is_beside(normal, other) * (1.0F - hit->distance / reach);
                         }
                       });
        rays += pattern.size();
        // Half of the rays leave at once at an edge of 90 degrees.
        convexities[index] = static_cast<float>(std::min(1.0, 2.0 * sum / static_cast<double>(pattern.size())));
      });
}

GrainCount trace_grains(const MeshScene& scene, const Fall& fall, const GrainTarget& target, std::uint64_t grains,
                        std::uint64_t seed, ThreadPool& pool) {
  std::vector<GrainCount> counts((grains + kGrainsPerTask - 1) / kGrainsPerTask);
  pool.run(counts.size(), [&](std::size_t task) {
    Rng rng(seed, task);
    GrainCount& count = counts[task];
    count.stopped.assign(scene.parts(), 0);
    const std::uint64_t last = std::min(grains, (task + 1) * kGrainsPerTask);
    for (std::uint64_t grain = task * kGrainsPerTask; grain < last; ++grain) {
      const auto a = static_cast<float>(rng.uniform());
      const auto b = static_cast<float>(rng.uniform());
      const double azimuth = 2.0 * kPi * rng.uniform();
      const float slope = slope_of(fall.sin_spread, static_cast<float>(rng.uniform()));
      const float t1 = slope * static_cast<float>(std::cos(azimuth)) - fall.wind1;
      const float t2 = slope * static_cast<float>(std::sin(azimuth)) - fall.wind2;
      MeshRay ray;
      for (std::size_t k = 0; k < 3; ++k) {
        ray.origin[k] = target.corner[k] + a * target.edge1[k] + b * target.edge2[k];
        ray.direction[k] = fall.up[k] + t1 * fall.across1[k] + t2 * fall.across2[k];
      }
      ray.farthest = kInfinity;
      MeshHit hit = scene.first_hit(ray);
      if (hit.part < 0) {
        for (float& d : ray.direction) {
          d = -d;
        }
        hit = scene.first_hit(ray);
      }
      ++(hit.part < 0   ? count.missed
         : hit.part > 0 ? count.stopped[static_cast<std::size_t>(hit.part)]
         : hit.front    ? count.front
                        : count.back);
    }
  });
  GrainCount sum;
  sum.stopped.assign(scene.parts(), 0);
  for (const GrainCount& count : counts) {
    sum.front += count.front;
    sum.back += count.back;
    sum.missed += count.missed;
    for (std::size_t part = 0; part < sum.stopped.size(); ++part) {
      sum.stopped[part] += count.stopped[part];
    }
  }
  return sum;
}

}  // namespace lamina
