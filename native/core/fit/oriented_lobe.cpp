// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/oriented_lobe.hpp"

#include "fit/visible_chord.hpp"
#include "numeric/quadrature.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamina {

using Eigen::Index;

OrientedLobe::OrientedLobe(const OrientedShape& shape, double mu_o, double phi_o) {
  constexpr double kMostAnisotropy = 0.99;  // of Cycles
  const double alpha = shape.roughness * shape.roughness;
  const double squeeze = 1.0 - std::min(std::hypot(shape.along, shape.across), kMostAnisotropy);
  alpha_x_ = alpha * squeeze;
  alpha_y_ = std::min(1.0, alpha / squeeze);  // Cycles clamps alpha to 1
  const double sin_o = std::sqrt(std::max(0.0, 1.0 - mu_o * mu_o));
  const double turn = 0.5 * std::atan2(shape.across, shape.along);
  const Vector normal = Vector(shape.tilt * sin_o, shape.aside * sin_o, 1.0 + shape.tilt * mu_o).normalized();
  // The layer's tangent across the tilted normal, turned about this, as by the socket Rotation
  const Vector across = normal.cross(Vector(std::cos(phi_o), -std::sin(phi_o), 0.0)).normalized();
  const Vector along = across.cross(normal);
  axes_ << (std::cos(turn) * along + std::sin(turn) * across).transpose(),
      (std::cos(turn) * across - std::sin(turn) * along).transpose(), normal.transpose();
  view_ = axes_ * Vector(sin_o, 0.0, mu_o);
  upright_ = axes_.col(2);
  if (view_.z() > 0.0) lambda_view_ = lambda(view_);
}

double OrientedLobe::lambda(const Vector& direction) const {
  const double across = Eigen::Vector2d(alpha_x_ * direction.x(), alpha_y_ * direction.y()).norm() / direction.z();
  return 0.5 * (std::sqrt(1.0 + across * across) - 1.0);
}

void OrientedLobe::values(const LightDirections& light, Eigen::Ref<Eigen::VectorXd> out) const {
  if (!(view_.z() > 0.0)) {
    out.setZero();
    return;
  }
  // Without temporary arrays
  const auto along = [&](Index axis) {
    return axes_(axis, 0) * light.x + axes_(axis, 1) * light.y + axes_(axis, 2) * light.z;
  };
  const auto x = along(0);
  const auto y = along(1);
  const auto z = along(2).max(0.0);
  const auto across2 = (alpha_x_ * x).square() + (alpha_y_ * y).square();
  const auto masking = (0.5 + lambda_view_) * z + 0.5 * (z.square() + across2).sqrt();  // times z
  // GGX's distribution at the half vector
  const auto half_x = view_.x() + x;
  const auto half_y = view_.y() + y;
  const auto half_z2 = (view_.z() + z).square();
  const auto length2 = half_x.square() + half_y.square() + half_z2;
  const auto stretched = (1.0 / alpha_x_ * half_x).square() + (1.0 / alpha_y_ * half_y).square() + half_z2;
  const double scale = 1.0 / (4.0 * view_.z() * std::numbers::pi * alpha_x_ * alpha_y_);
  out = (scale * length2.square() * z / (stretched.square() * masking)).matrix();
}

double OrientedLobe::reflected(const Chord& chord, double along) const {
  const double t2 = (1.0 - chord.lift) * chord.half + chord.lift * chord.half * along;
  const double outwards = std::sqrt(std::max(0.0, 1.0 - chord.t1 * chord.t1 - t2 * t2));
  Vector normal = chord.t1 * chord.first + t2 * chord.second + outwards * chord.view;
  normal = Vector(alpha_x_ * normal.x(), alpha_y_ * normal.y(), std::max(normal.z(), 1e-12)).normalized();
  const Vector light = 2.0 * view_.dot(normal) * normal - view_;
  const double above = std::min(light.z(), light.dot(upright_));
  return above > 0.0 ? (1.0 + lambda_view_) / (1.0 + lambda_view_ + lambda(light)) : above;
}

double OrientedLobe::albedo() const {
  if (!(view_.z() > 0.0)) return 0.0;
  // The view stretched to the hemisphere of facets of width 1, and a frame about it. Normals are spread evenly over a
  // disk.
  const Quadrature& rule = disk_rule();
  const Vector view = Vector(alpha_x_ * view_.x(), alpha_y_ * view_.y(), view_.z()).normalized();
  const double level = std::hypot(view.x(), view.y());
  const Vector first = level > 1e-9 ? Vector(-view.y() / level, view.x() / level, 0.0) : Vector(1.0, 0.0, 0.0);
  const Vector second = view.cross(first);
  double sum = 0.0;
  for (Index i = 0; i < rule.mu.size(); ++i) {
    const double angle = 0.5 * std::numbers::pi * rule.mu[i];
    const Chord chord{first, second, view, std::sin(angle), std::cos(angle), 0.5 * (1.0 + view.z())};
    const ChordLight light = chord_light([&](double along) { return reflected(chord, along); });
    // dt1 = half d(asin t1); the disk's area is pi
    sum += 0.5 * std::numbers::pi * rule.weight[i] * chord.half * chord.half * 0.5 * light.length * light.sum;
  }
  return sum / std::numbers::pi;
}

}  // namespace lamina
