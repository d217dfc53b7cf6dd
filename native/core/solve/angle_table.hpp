// SPDX-License-Identifier: GPL-3.0-or-later
// The smooth part of a solved stack on angles in even steps, for many directions or many calls.
#pragma once
#include <Eigen/Core>
#include <array>
#include <memory>
#include <mutex>
#include <vector>

namespace lamina {

/// All azimuth orders of a smooth function of two cosines, with Lagrange interpolation on six neighbouring knots of a
/// uniform grid in the angle.
class AngleTable {
 public:
  static constexpr Eigen::Index kKnots = 241;

  /// The cosines of the knots.
  static Eigen::VectorXd cosines();

  /// `orders`: [knot, knot] by azimuth order. `meets`: some light is scattered twice by facets, and is no part of them.
  AngleTable(const std::vector<Eigen::MatrixXd>& orders, bool meets);

  /// All orders at a pair of cosines.
  Eigen::ArrayXd at(double mu_o, double mu_i) const;
  bool meets() const { return meets_; }

 private:
  Eigen::ArrayXXf values_;  // [order, knot_o + kKnots * knot_i]
  bool meets_;
};

/// The tables of one solution, by the side where light enters and by path. They are made when first asked for; each
/// takes .23 MB per azimuth order.
class KeptTables {
 public:
  static constexpr std::size_t kTables = 4;

  template <typename Make>
  std::shared_ptr<const AngleTable> known_or_made(std::size_t number, const Make& make) {
    const std::scoped_lock guard(lock_);
    if (!known_[number]) {
      known_[number] = make();
    }
    return known_[number];
  }

 private:
  std::mutex lock_;
  std::array<std::shared_ptr<const AngleTable>, kTables> known_;
};

}  // namespace lamina
