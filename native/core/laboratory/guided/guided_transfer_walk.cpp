// SPDX-License-Identifier: GPL-3.0-or-later
#include "guided/guided_transfer_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "events/sphere.hpp"
#include "guided/adjoint_source.hpp"
#include "matter/graded_single_scattering.hpp"
#include "matter/single_scattering_shape.hpp"
#include "numeric/azimuth_lattice.hpp"
#include "walks/next_event.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Flights per collision. On a lattice, 16 are 2.3 times as efficient as 8, and 32 are 6.6 times.
constexpr int kCandidates = 32;
using Values = Eigen::Array<float, kCandidates, 1>;

/// Continuation probability of a collision as important as the first ones (weight times importance), and its minimum.
/// Any values are unbiased.
constexpr double kEager = 0.6;
constexpr double kLeastOn = 0.05;

/// Made on the first call: code at the start of the program would run before the check of the processor.
const AzimuthLattice<kCandidates>& lattice() {
  static const AzimuthLattice<kCandidates> made;
  return made;
}

/// Directions about a ray.
class RayFrame {
 public:
  explicit RayFrame(const Ray& axis) : axis_(axis), others_(tangents_of(axis.x, axis.y, axis.z)) {}
  Ray tilted(double cosine, double along, double aside) const {
    return normalised({cosine * axis_.x + along * others_.first[0] + aside * others_.second[0],
                       cosine * axis_.y + along * others_.first[1] + aside * others_.second[1],
                       cosine * axis_.z + along * others_.first[2] + aside * others_.second[2]});
  }

 private:
  Ray axis_;
  Tangents<double> others_;
};

/// (1 - exp(-rate way)) / rate, rate >= 0.
Values decayed(const Values& rate, const Values& way) {
  const Values depth = rate * way;
  return (depth < 1e-4F).select(way * (1.0F - 0.5F * depth), -(-depth).expm1() / rate.max(1e-30F));
}

class GuidedTransferWalk final : public Walk {
 public:
  GuidedTransferWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi)
      : medium_(medium),
        tau_(medium.tau()),
        in_{sine_of(mu_i), 0.0, -mu_i},
        out_{sine_of(mu_o) * std::cos(dphi), sine_of(mu_o) * std::sin(dphi), mu_o},
        exit_(out_),
        importance_(medium_, out_),
        both_(fitted(NextEvent::kFitting, medium.sharpest_phase()) == NextEvent::kFromBothEnds),
        from_ground_(4.0 * mu_o * medium.ground() * std::exp(-tau_ / mu_o)),
        passes_(std::exp(-tau_ / mu_i)),
        collides_(-std::expm1(-tau_ / mu_i)) {
    const double cosine = in_.dot(out_);
    const double scattered = medium.is_homogeneous()
                                 ? medium_.at(0.0).evaluate(cosine) * single_reflection(mu_o, mu_i, tau_)
                                 : scattered_once(medium_, false, mu_o, mu_i, cosine);
    once_ = (scattered + passes_ * from_ground_ / mu_o) / (4.0 * pi);
    lay_first();
  }

  double sample(Rng& rng, std::uint64_t& events) const override {
    ++events;
    if (!(total_ > 0.0)) {
      return once_;
    }

    // Sample the first collision, or arrival at the ground, in proportion to its importance
    const double place = rng.uniform() * total_;
    const auto above = std::upper_bound(below_.begin() + 1, below_.end() - 1, place);
    const auto bin = static_cast<std::size_t>(above - below_.begin()) - 1;
    const double mass = below_[bin + 1] - below_[bin];
    const double usual = collides_ * total_;
    Vertex at = grounded();
    double weight = 0.0;
    if (bin + 1 == edges_.size()) {
      weight = usual / at.importance;
    } else {
      const double width = edges_[bin + 1] - edges_[bin];
      const double depth = first_depth(edges_[bin] + width * rng.uniform());
      at = {in_, depth, importance(depth, in_)};
      weight = collides_ * width * total_ / mass;
    }

    double score = 0.0;
    while (true) {
      // Continue with probability q, else score the table's importance
      const double q = std::clamp(kEager * weight * at.importance / usual, kLeastOn, 1.0);
      if (rng.uniform() >= q) {
        score += weight * at.importance;
        break;
      }
      score += weight * at.importance * (1.0 - 1.0 / q);
      weight /= q;
      ++events;

      // Score the next event along several flights, and continue from the end of one of them
      const Flights flights = flights_from(at, rng);
      score += weight * next_event(at, flights);
      const double factor = move_on(flights, at, rng);
      if (factor == 0.0) {
        break;
      }
      weight *= factor;
    }
    return once_ + score / (4.0 * pi * out_.z);
  }

 private:
  static constexpr std::size_t kFirst = 512;  // equal steps of the first collision's probability

  /// A collision, or an arrival at the ground.
  struct Vertex {
    Ray ray;  ///< the direction that the light arrives in
    double depth;
    double importance;
    bool is_ground = false;
  };

  /// Candidates for the flight after a vertex.
  struct Flights {
    std::array<Ray, kCandidates> rays;
    Values x;
    Values y;
    Values z;
    Values share;     ///< the albedo times the balance heuristic's weight
    Values length;    ///< to the face ahead
    Values through;   ///< probability of reaching that face
    Values collides;  ///< and of a collision before it
    Values ends;      ///< depth of this collision
  };

  Vertex grounded() const { return {in_, tau_, importance_.of_ground(), true}; }

  /// Integrates the importance of the first collision over its probability, in steps of equal probability and at the
  /// depths of a graded medium's table; the last step is the ground.
  void lay_first() {
    for (std::size_t k = 0; k <= kFirst; ++k) {
      edges_.push_back(static_cast<double>(k) / kFirst);
    }
    if (!medium_.is_homogeneous()) {
      for (const double depth : importance_.depths()) {
        edges_.push_back(std::min(1.0, -std::expm1(depth / in_.z) / collides_));
      }
      std::sort(edges_.begin(), edges_.end());
    }
    double before = importance(0.0, in_);
    for (std::size_t k = 0; k + 1 < edges_.size(); ++k) {
      const double after = importance(first_depth(edges_[k + 1]), in_);
      below_.push_back(total_);
      total_ += 0.5 * (edges_[k + 1] - edges_[k]) * (before + after);
      before = after;
    }
    below_.push_back(total_);
    if (importance_.of_ground() > 0.0) {
      total_ += passes_ / collides_ * importance_.of_ground();
      below_.push_back(total_);
    }
  }

  Flights flights_from(const Vertex& at, Rng& rng) const {
    Flights flights;
    if (at.is_ground) {
      flights.share = reflect(flights.rays, rng);
    } else {
      const LocalScattering local = medium_.at_depth(at.depth);
      flights.share = both_ ? scatter<kCandidates * 5 / 8>(local, at.ray, flights.rays, rng)
                            : scatter<kCandidates>(local, at.ray, flights.rays, rng);
    }
    const double shift = rng.uniform();
    Values part;  // uniform numbers that place the ends
    for (int k = 0; k < kCandidates; ++k) {
      const Ray& next = flights.rays[static_cast<std::size_t>(k)];
      flights.x[k] = static_cast<float>(next.x);
      flights.y[k] = static_cast<float>(next.y);
      flights.z[k] = static_cast<float>(next.z);
      // A lattice with the directions, shifted in both, so that each end alone is uniform.
      const double place = shift + static_cast<double>((5 * k) % kCandidates) / kCandidates;
      part[k] = static_cast<float>(place < 1.0 ? place : place - 1.0);
    }
    const auto here = static_cast<float>(at.depth);
    const Values& z = flights.z;
    const Values distance = (z > 0.0F).select(Values::Constant(here), here - static_cast<float>(tau_)) / z;
    flights.length = (z.abs() > 1e-7F).select(distance, 1e6F).min(1e6F);
    flights.through = (-flights.length).exp();
    flights.collides = -(-flights.length).expm1();
    const Values way = -(-part.min(0.9999999F) * flights.collides).log1p();
    flights.ends = (here - z * way).max(0.0F).min(static_cast<float>(tau_));
    return flights;
  }

  /// The mean over the flights of the next event: exp(-s) times the light that scatters there to the viewer, in
  /// proportion to exp(-(depth - s z) / mu_o). Integrated along each flight in a homogeneous medium, at its end in a
  /// graded one; and the light that the ground reflects.
  double next_event(const Vertex& at, const Flights& flights) const {
    const auto& [rays, x, y, z, share, length, through, collides, ends] = flights;
    const auto slowness = static_cast<float>(1.0 / out_.z);
    const Values cosine =
        static_cast<float>(out_.x) * x + static_cast<float>(out_.y) * y + static_cast<float>(out_.z) * z;
    double ground = 0.0;
    if (from_ground_ > 0.0) {
      ground = from_ground_ * static_cast<double>((z < 0.0F).select(share * through, 0.0F).mean());
    }
    if (!medium_.is_homogeneous()) {
      Values k_out;
      for (Eigen::Index k = 0; k < kCandidates; ++k) {
        k_out[k] =
            static_cast<float>(medium_.at_depth(static_cast<double>(ends[k])).evaluate(static_cast<double>(cosine[k])));
      }
      return ground + static_cast<double>((share * collides * k_out * (-slowness * ends).exp()).mean());
    }
    const Values rate = 1.0F - z * slowness;
    const Values kept = (rate < 0.0F).select(through, static_cast<float>(std::exp(-at.depth / out_.z)));
    const Values k_out = medium_.at(0.0).evaluate_all(cosine);
    return ground + static_cast<double>((share * k_out * kept * decayed(rate.abs(), length)).mean());
  }

  /// Moves to the end of one flight, resampled by the tabulated importance of the ends. Returns the factor of the
  /// weight, 0 if no flight has an end of any importance.
  double move_on(const Flights& flights, Vertex& at, Rng& rng) const {
    const auto& [rays, x, y, z, share, length, through, collides, ends] = flights;
    const Values further = importance_(ends, x, y, z);
    const Values chances = share * collides * further;
    double ground = 0.0;
    if (importance_.of_ground() > 0.0) {
      ground = importance_.of_ground() * static_cast<double>((z < 0.0F).select(share * through, 0.0F).sum());
    }
    const auto all = static_cast<double>(chances.sum()) + ground;
    if (!(all > 0.0)) {
      return 0.0;
    }
    double rest = rng.uniform() * all;
    if (rest < ground) {
      at = grounded();
      return all / (kCandidates * at.importance);
    }
    rest -= ground;
    int chosen = 0;
    for (int k = 0; k < kCandidates; ++k) {
      if (chances[k] > 0.0F) {
        chosen = k;
        rest -= static_cast<double>(chances[k]);
        if (rest < 0.0) {
          break;
        }
      }
    }
    at = {rays[static_cast<std::size_t>(chosen)], static_cast<double>(ends[chosen]),
          static_cast<double>(further[chosen])};
    return all / (kCandidates * at.importance);
  }

  /// The depth of the first collision with the probability u of a smaller one.
  double first_depth(double u) const { return std::min(tau_, in_.z * std::log1p(-u * collides_)); }

  double importance(double depth, const Ray& ray) const {
    using One = Eigen::Array<float, 1, 1>;
    const auto one = [](double x) { return One::Constant(static_cast<float>(x)); };
    return static_cast<double>(importance_(One(one(depth)), One(one(ray.x)), One(one(ray.y)), One(one(ray.z)))[0]);
  }

  /// Fills `rays` with directions from the ground, on a lattice in proportion to their cosine. Returns its reflectance.
  Values reflect(std::array<Ray, kCandidates>& rays, Rng& rng) const {
    const double shift = rng.uniform();
    const RayFrame up({0.0, 0.0, 1.0});
    const double turn = 2.0 * pi * rng.uniform();
    for (std::size_t k = 0; k < kCandidates; ++k) {
      const double square = (static_cast<double>(k) + shift) / kCandidates;
      rays[k] = lattice_ray(up, std::sqrt(square), k, std::cos(turn), std::sin(turn));
    }
    return Values::Constant(static_cast<float>(medium_.ground()));
  }

  /// Direction k of the lattice about an axis, turned by an angle of this cosine and sine.
  static Ray lattice_ray(const RayFrame& axis, double cosine, std::size_t k, double turn_cosine, double turn_sine) {
    const double sine = sine_of(cosine);
    const AzimuthLattice<kCandidates>& azimuths = lattice();
    const double along = sine * (turn_cosine * azimuths.cosine[k] - turn_sine * azimuths.sine[k]);
    const double aside = sine * (turn_sine * azimuths.cosine[k] + turn_cosine * azimuths.sine[k]);
    return axis.tilted(cosine, along, aside);
  }

  /// Fills `rays` with directions after a collision, on a lattice: kOwn scattered from `ray`, the others scattered
  /// backwards from the exit. Returns the albedo times the weights of the balance heuristic.
  template <int kOwn>
  Values scatter(const LocalScattering& local, const Ray& ray, std::array<Ray, kCandidates>& rays, Rng& rng) const {
    constexpr int kBack = kCandidates - kOwn;
    const double shift = rng.uniform();
    const double turn = 2.0 * pi * rng.uniform();
    const double turn_cosine = std::cos(turn);
    const double turn_sine = std::sin(turn);
    const RayFrame around(ray);
    Values from_ray;
    Values from_exit;
    for (std::size_t k = 0; k < kCandidates; ++k) {
      const bool own = k < kOwn;
      const auto number = static_cast<double>(own ? k : k - kOwn);
      const double cosine = local.sample((number + shift) / (own ? kOwn : kBack));
      const Ray next = lattice_ray(own ? around : exit_, cosine, k, turn_cosine, turn_sine);
      rays[k] = next;
      const auto i = static_cast<Eigen::Index>(k);
      from_ray[i] = static_cast<float>(ray.dot(next));
      from_exit[i] = static_cast<float>(next.dot(out_));
    }
    const auto albedo = static_cast<float>(local.albedo());
    if constexpr (kBack == 0) {
      return Values::Constant(albedo);
    } else {
      const Values p = local.evaluate_all(from_ray);
      const Values q = local.evaluate_all(from_exit);
      constexpr auto kAll = static_cast<float>(kCandidates);
      const Values both = static_cast<float>(kOwn) * p + static_cast<float>(kBack) * q;
      return albedo * kAll * p / both.max(1e-30F);
    }
  }

  GradedMedium medium_;
  double tau_;
  Ray in_;
  Ray out_;
  RayFrame exit_;
  AdjointSource importance_;
  bool both_;
  double from_ground_;         ///< next event of light that reaches the ground
  double passes_;              ///< probability that the first flight reaches the ground
  double collides_;            ///< and that it collides before
  double once_ = 0.0;          ///< the BRDF's single scattering
  double total_ = 0.0;         ///< the last of `below_`
  std::vector<double> edges_;  ///< of the steps, in the first collision's probability
  std::vector<double> below_;  ///< integral of the importance of the first collision up to each edge, then the ground's
};

}  // namespace

std::unique_ptr<Walk> make_guided_transfer_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi) {
  if (!medium.is_homogeneous() && mu_o < mu_i) {
    // Next events are at the ends of flights, which a grazing view would rarely see. By reciprocity the light grazes.
    std::swap(mu_o, mu_i);
  }
  return std::make_unique<GuidedTransferWalk>(medium, mu_o, mu_i, dphi);
}

}  // namespace lamina
