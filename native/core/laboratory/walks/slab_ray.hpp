// SPDX-License-Identifier: GPL-3.0-or-later
// A direction of light in a slab: horizontal part and cosine.
#pragma once
#include <algorithm>
#include <cmath>

namespace lamina {

/// A direction of light or towards the viewer: the horizontal part of the direction of travel, and the cosine with the
/// normal, positive both upwards and downwards.
struct SlabRay {
  double x = 0.0;
  double y = 0.0;
  double mu = 1.0;

  static SlabRay of(double mu, double azimuth) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - mu * mu));
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
  }
};

/// The cosine between two rays that cross the layer in opposite senses, and in the same sense.
inline double turned_back(const SlabRay& a, const SlabRay& b) { return a.x * b.x + a.y * b.y - a.mu * b.mu; }
inline double passed_on(const SlabRay& a, const SlabRay& b) { return a.x * b.x + a.y * b.y + a.mu * b.mu; }

/// Directions about a ray.
class SlabFrame {
 public:
  explicit SlabFrame(const SlabRay& axis) : axis_(axis), sine_(std::sqrt(axis.x * axis.x + axis.y * axis.y)) {
    if (sine_ > 0.0) {
      x_ = axis.x / sine_;
      y_ = axis.y / sine_;
    }
  }

  /// The direction with this cosine to the axis and these two components across it; mu <= 0 is beyond the horizon.
  SlabRay tilted(double cosine, double along, double aside) const {
    const double outward = cosine * sine_ + along * axis_.mu;
    return {outward * x_ - aside * y_, outward * y_ + aside * x_, cosine * axis_.mu - along * sine_};
  }
  SlabRay turned(double cosine, double azimuth) const {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return tilted(cosine, sine * std::cos(azimuth), sine * std::sin(azimuth));
  }

 private:
  SlabRay axis_;
  double sine_;
  double x_ = 1.0;
  double y_ = 0.0;
};

}  // namespace lamina
