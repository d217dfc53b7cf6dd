// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/moving_lobe.hpp"

#include "fit/visible_chord.hpp"
#include "numeric/quadrature.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina {

using Eigen::Index;

LightDirections::LightDirections(const Eigen::Ref<const Eigen::VectorXd>& mu,
                                 const Eigen::Ref<const Eigen::VectorXd>& dphi)
    : x(mu.size() * dphi.size()), y(x.size()), z(x.size()) {
  for (Index i = 0; i < mu.size(); ++i) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - mu[i] * mu[i]));
    for (Index j = 0; j < dphi.size(); ++j) {
      const Index k = i * dphi.size() + j;
      x[k] = -sine * std::cos(dphi[j]);
      y[k] = -sine * std::sin(dphi[j]);
      z[k] = mu[i];
    }
  }
}

MovingLobe::MovingLobe(const LobeShape& shape, double mu_o) {
  const double alpha = shape.roughness * shape.roughness;
  const double squeeze = 1.0 - std::abs(shape.anisotropy);
  const double narrow = alpha * squeeze;
  const double wide = std::min(1.0, alpha / squeeze);  // Cycles clamps alpha to 1
  alpha_x_ = shape.anisotropy > 0.0 ? narrow : wide;
  alpha_y_ = shape.anisotropy > 0.0 ? wide : narrow;
  const double sin_o = std::sqrt(std::max(0.0, 1.0 - mu_o * mu_o));
  const double normal_x = shape.tilt * sin_o;
  const double normal_z = 1.0 + shape.tilt * mu_o;
  const double length = std::hypot(normal_x, normal_z);
  sin_tilt_ = normal_x / length;
  cos_tilt_ = normal_z / length;
  view_x_ = sin_o * cos_tilt_ - mu_o * sin_tilt_;
  view_z_ = sin_o * sin_tilt_ + mu_o * cos_tilt_;
  lambda_view_ = view_z_ > 0.0 ? lambda(view_x_, 0.0, view_z_) : 0.0;
}

double MovingLobe::lambda(double x, double y, double z) const {
  const double across = alpha_x_ * x * alpha_x_ * x + alpha_y_ * y * alpha_y_ * y;
  return 0.5 * (std::sqrt(1.0 + across / (z * z)) - 1.0);
}

void MovingLobe::values(const LightDirections& light, Eigen::Ref<Eigen::VectorXd> out) const {
  if (!(view_z_ > 0.0)) {
    out.setZero();
    return;
  }
  // The light in the frame of the tilted normal, without temporary arrays
  const auto x = light.x * cos_tilt_ - light.z * sin_tilt_;
  const auto y2 = light.y.square();
  const auto z = (light.x * sin_tilt_ + light.z * cos_tilt_).max(0.0);
  const auto across2 = (alpha_x_ * x).square() + alpha_y_ * alpha_y_ * y2;
  const auto masking = (0.5 + lambda_view_) * z + 0.5 * (z.square() + across2).sqrt();  // times z
  // GGX's distribution at the half vector
  const auto half_x = view_x_ + x;
  const auto half_z2 = (view_z_ + z).square();
  const auto length2 = half_x.square() + y2 + half_z2;
  const auto stretched = (1.0 / alpha_x_ * half_x).square() + 1.0 / (alpha_y_ * alpha_y_) * y2 + half_z2;
  const double scale = 1.0 / (4.0 * view_z_ * std::numbers::pi * alpha_x_ * alpha_y_);
  out = (scale * length2.square() * z / (stretched.square() * masking)).matrix();
}

double MovingLobe::reflected(const Chord& chord, double along) const {
  const double t2 = (1.0 - chord.lift) * chord.half + chord.lift * chord.half * along;
  const double upright = std::sqrt(std::max(0.0, 1.0 - chord.t1 * chord.t1 - t2 * t2));
  // t2 points along (-stretched_z, 0, stretched_x)
  double normal_x = alpha_x_ * (upright * chord.stretched_x - t2 * chord.stretched_z);
  double normal_y = alpha_y_ * chord.t1;
  double normal_z = std::max(upright * chord.stretched_z + t2 * chord.stretched_x, 1e-12);
  const double norm = std::sqrt(normal_x * normal_x + normal_y * normal_y + normal_z * normal_z);
  normal_x /= norm;
  normal_y /= norm;
  normal_z /= norm;
  const double twice = 2.0 * (view_x_ * normal_x + view_z_ * normal_z);
  const double x = twice * normal_x - view_x_;
  const double z = twice * normal_z - view_z_;
  const double above = std::min(z, z * cos_tilt_ - x * sin_tilt_);
  if (!(above > 0.0)) return above;
  return (1.0 + lambda_view_) / (1.0 + lambda_view_ + lambda(x, twice * normal_y, z));
}

double MovingLobe::albedo() const {
  if (!(view_z_ > 0.0)) return 0.0;
  // The view stretched to the hemisphere of facets of width 1, and a frame about it: t1 along y, t2 in the plane of
  // incidence. Normals are spread evenly over a disk; by symmetry, over one half
  const Quadrature& rule = disk_rule();
  const double length = std::hypot(alpha_x_ * view_x_, view_z_);
  const double stretched_z = view_z_ / length;
  double sum = 0.0;
  for (Index i = 0; i < rule.mu.size(); ++i) {
    const double angle = 0.25 * std::numbers::pi * (1.0 + rule.mu[i]);
    const Chord chord{std::sin(angle), std::cos(angle), alpha_x_ * view_x_ / length, stretched_z,
                      0.5 * (1.0 + stretched_z)};
    const ChordLight light = chord_light([&](double along) { return reflected(chord, along); });
    // dt1 = chord d(asin t1); the integral over the half disk of area pi / 2
    sum += 0.25 * std::numbers::pi * rule.weight[i] * chord.half * chord.half * 0.5 * light.length * light.sum;
  }
  return sum * 2.0 / std::numbers::pi;
}

}  // namespace lamina
