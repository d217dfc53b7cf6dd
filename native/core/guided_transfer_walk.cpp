// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided_transfer_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "flight.hpp"
#include "next_event.hpp"
#include "sphere.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

constexpr int kCandidates = 8;
using Values = Eigen::Array<float, kCandidates, 1>;

/// What a collision is worth: the tables' k + kS towards the viewer from its height, and what a diffuse field brings.
class CollisionWorth {
 public:
  CollisionWorth(const GradedMedium& medium, const ScatteringGuide& guide, const Ray& out)
      : heights_(guide.heights()), slowness_(1.0 / out.z), tau_(medium.tau()) {
    const double sine = std::hypot(out.x, out.y);
    across_ = sine > 0.0 ? Ray{out.x / sine, out.y / sine, 0.0} : Ray{1.0, 0.0, 0.0};
    for (std::size_t j = 0; j < heights_.size(); ++j) {
      const std::vector<float> towards = guide.one_side_towards(out.z, j);
      double sum = 0.0;
      for (const float one : towards) {
        sum += static_cast<double>(one);
      }
      table_.insert(table_.end(), towards.begin(), towards.end());
      mean_[j] = static_cast<float>(sum / static_cast<double>(towards.size()));
    }
    const LocalScattering scattering = medium.at(0.0);
    const double albedo = scattering.albedo();
    const double g = scattering.p->moment(1);
    decay_ = std::sqrt(std::max(0.0, 3.0 * (1.0 - albedo) * (1.0 - albedo * g)));
    diffuse_ = 3.0 * albedo * out.z * (0.2 + static_cast<double>(mean_.back()));
  }

  /// Without single scattering, and without what the way to the viewer keeps; height t, direction of travel.
  float repeated(double t, const Ray& ray) const {
    const std::size_t j = heights_.cell(t, heights_.last_cell());
    const auto up = static_cast<float>(heights_.fraction(t, j));
    if (ray.z >= 0.0) {
      return mean_[j] + up * (mean_[j + 1] - mean_[j]);
    }
    using Place = ScatteringGuide::Place;
    constexpr std::size_t kPoints = ScatteringGuide::kPoints;
    const Place p = Place::of_cosine(-ray.z);
    const double square = ray.x * ray.x + ray.y * ray.y;
    const double cosine = square > 1e-24 ? (ray.x * across_.x + ray.y * across_.y) / std::sqrt(square) : 1.0;
    const Place z = Place::of(std::sqrt(std::clamp(0.5 - 0.5 * cosine, 0.0, 1.0)));
    const auto at = [&](std::size_t k) {
      const float* low = &table_[(k * kPoints + p.cell) * kPoints + z.cell];
      const float* high = low + kPoints;
      const float lower = low[0] + z.fraction * (low[1] - low[0]);
      const float upper = high[0] + z.fraction * (high[1] - high[0]);
      return lower + p.fraction * (upper - lower);
    };
    const float below = at(j);
    return below + up * (at(j + 1) - below);
  }

  double kept(double t) const { return std::exp((t - tau_) * slowness_); }
  double slowness() const { return slowness_; }
  double decay() const { return decay_; }
  double diffuse() const { return diffuse_; }

 private:
  GuideHeights heights_;
  Ray across_;
  double slowness_;
  double tau_;
  double decay_ = 0.0;  ///< of a diffuse field, by optical depth
  double diffuse_ = 0.0;
  std::vector<float> table_;  // [height, cosine, azimuth]
  std::array<float, GuideHeights::kCount> mean_{};
};

class GuidedTransferWalk final : public Walk {
 public:
  GuidedTransferWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi, const ScatteringGuide& guide)
      : medium_(medium),
        scattering_(medium_.at(0.0)),
        tau_(medium.tau()),
        in_{sine_of(mu_i), 0.0, -mu_i},
        out_{sine_of(mu_o) * std::cos(dphi), sine_of(mu_o) * std::sin(dphi), mu_o},
        worth_(medium_, guide, out_),
        both_(fitted(NextEvent::kFitting, *scattering_.p) == NextEvent::kFromBothEnds) {
    first_.fill(in_);
    // What the first flight is worth, by the midpoint rule in the probability of its end.
    constexpr int kPoints = 64;
    const double whole = -std::expm1(-tau_ / mu_i);
    for (int k = 0; k < kPoints; ++k) {
      const double t = std::max(0.0, tau_ + mu_i * std::log(1.0 - (k + 0.5) / kPoints * whole));
      usual_ += whole / kPoints * value(t, in_);
    }
  }

  double sample(Rng& rng, std::uint64_t& events) const override {
    double score = 0.0;
    double weight = 1.0;
    double t = tau_;
    Values share = Values::Ones();
    std::array<Ray, kCandidates> rays = first_;
    while (true) {
      ++events;
      // Ends of flights, one on each ray.
      const double shift = rng.uniform();
      Values length;
      Values part;
      for (int k = 0; k < kCandidates; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double z = rays[i].z;
        length[k] = static_cast<float>(std::min(1e6, z > 0.0 ? (tau_ - t) / z : -t / z));
        // A lattice with the directions, shifted in both, so that each end alone is uniform.
        const double place = shift + static_cast<double>((5 * k) % kCandidates) / kCandidates;
        part[k] = static_cast<float>(place < 1.0 ? place : place - 1.0);
      }
      const Values whole = 1.0F - (-length).exp();
      const Values way = -(1.0F - part * whole).log();
      std::array<double, kCandidates> height;
      Values cosine;
      Values rise;
      for (int k = 0; k < kCandidates; ++k) {
        const auto i = static_cast<std::size_t>(k);
        height[i] = std::clamp(t + rays[i].z * static_cast<double>(way[k]), 0.0, tau_);
        cosine[k] = static_cast<float>(rays[i].dot(out_));
        rise[k] = static_cast<float>(height[i] - tau_);
      }
      const Values k_out = scattering_.evaluate_all(cosine);
      const Values kept = (rise * static_cast<float>(worth_.slowness())).exp();
      const Values diffuse = (rise * static_cast<float>(worth_.decay())).exp() * static_cast<float>(worth_.diffuse());
      Values more;
      for (int k = 0; k < kCandidates; ++k) {
        const auto i = static_cast<std::size_t>(k);
        more[k] = worth_.repeated(height[i], rays[i]);
      }
      // Next event, at all candidates.
      const Values arriving = share * whole;
      score += weight * static_cast<double>((arriving * kept * k_out).mean());
      const Values further = kept * more + diffuse;
      const Values chances = arriving * further;
      const double total = static_cast<double>(chances.sum());
      if (!(total > 0.0)) {
        break;
      }
      // Whether to go on at all: by what is to come against what is usual.
      const double on = std::min(1.0, kEager * weight * total / kCandidates / usual_);
      if (rng.uniform() >= on) {
        break;
      }
      double rest = rng.uniform() * total;
      int chosen = kCandidates - 1;
      for (int k = 0; k < kCandidates; ++k) {
        if (chances[k] > 0.0F) {
          chosen = k;
          rest -= static_cast<double>(chances[k]);
          if (rest < 0.0) {
            break;
          }
        }
      }
      weight *= total / (kCandidates * static_cast<double>(further[chosen]) * on);
      const Ray ray = rays[static_cast<std::size_t>(chosen)];
      t = height[static_cast<std::size_t>(chosen)];
      share = both_ ? scatter<kCandidates - 3>(ray, rays, rng) : scatter<kCandidates>(ray, rays, rng);
    }
    return score / (4.0 * pi * out_.z);
  }

 private:
  /// Walks end only where next to nothing is to come: measured, 1 loses a factor of 2 and 25 a tenth.
  static constexpr double kEager = 8.0;

  double value(double t, const Ray& ray) const {
    return worth_.kept(t) * static_cast<double>(worth_.repeated(t, ray)) +
           worth_.diffuse() * std::exp((t - tau_) * worth_.decay());
  }

  /// Directions after a collision, some scattered backwards from the exit, and the albedo times their weights by the
  /// balance heuristic.
  template <int kOwn>
  Values scatter(const Ray& ray, std::array<Ray, kCandidates>& rays, Rng& rng) const {
    constexpr int kBack = kCandidates - kOwn;
    const double shift = rng.uniform();
    Values from_ray;
    Values from_exit;
    for (int k = 0; k < kCandidates; ++k) {
      const bool own = k < kOwn;
      const double place = own ? (k + shift) / kOwn : (k - kOwn + shift) / std::max(kBack, 1);
      const Ray next = scattered(own ? ray : out_, scattering_.sample(place), rng);
      rays[static_cast<std::size_t>(k)] = next;
      from_ray[k] = static_cast<float>(ray.dot(next));
      from_exit[k] = static_cast<float>(next.dot(out_));
    }
    const auto albedo = static_cast<float>(scattering_.albedo());
    if constexpr (kBack == 0) {
      return Values::Constant(albedo);
    } else {
      const Values p = scattering_.evaluate_all(from_ray);
      const Values q = scattering_.evaluate_all(from_exit);
      constexpr auto kAll = static_cast<float>(kCandidates);
      return albedo * kAll * p / (static_cast<float>(kOwn) * p + static_cast<float>(kBack) * q);
    }
  }

  GradedMedium medium_;
  LocalScattering scattering_;
  double tau_;
  Ray in_;
  Ray out_;
  CollisionWorth worth_;
  bool both_;
  std::array<Ray, kCandidates> first_;
  double usual_ = 0.0;  ///< what the first flight is worth
};

}  // namespace

std::unique_ptr<Walk> make_guided_transfer_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi,
                                                std::shared_ptr<const ScatteringGuide> guide) {
  if (!medium.is_homogeneous()) {
    throw std::invalid_argument("medium: must be homogeneous");
  }
  if (!guide) {
    guide = std::make_shared<const ScatteringGuide>(medium);
  }
  return std::make_unique<GuidedTransferWalk>(medium, mu_o, mu_i, dphi, *guide);
}

}  // namespace lamina
