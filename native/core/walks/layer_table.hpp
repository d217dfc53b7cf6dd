// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering function of one layer as a table for lookup and sampling.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "matter/stack.hpp"
#include "numeric/thread_pool.hpp"
#include "walks/sphere.hpp"

namespace lamina {

/// The scattering function of one layer for light that enters one side of it, to be looked up and sampled. Light
/// scattered once is in closed form; what is scattered more often, which is smooth, is a table of the solved layer,
/// cubics between knots that lie denser towards grazing and where light keeps its azimuth.
class LayerTable {
 public:
  static constexpr std::size_t kAngles = 76;    ///< from the normal to grazing
  static constexpr std::size_t kAzimuths = 64;  ///< from forward to backward

  /// Of a homogeneous layer, whose sides are alike. Throws std::runtime_error where it cannot be solved.
  LayerTable(const Medium& medium, ThreadPool& pool);
  /// Of a graded layer, for light that enters its top and its bottom: one solution, read from both sides.
  static std::array<LayerTable, 2> both_sides(const GradedMedium& graded, ThreadPool& pool);

  /// BRDF or BTDF of the layer in its own medium, for light along `in` that leaves along `out`.
  double value(const Ray& in, const Ray& out) const;

  /// Largest difference from the solved layer halfway between the table's knots, and the solution's own error of
  /// discretisation, relative to the layer's value, among cosines of at least .05.
  double error() const { return error_; }

  /// Of the light along a ray: what passes unscattered, and about how much leaves scattered.
  double unscattered(const Ray& in) const;
  double scattered(const Ray& in) const;

  /// Follows light through; false when it is lost. `first`: none passes unscattered, and the weight is relative to
  /// scattered(in).
  bool cross(Ray& ray, double& weight, bool first, Rng& rng) const;

 private:
  enum Way : std::size_t { kReflected, kPassed };

  /// For light in one range of angles: how much leaves by each way scattered more than once and once, and where to.
  struct Sampling {
    std::array<double, 2> repeated = {};
    double once = 0.0;
    std::array<std::vector<double>, 2> until;  ///< cumulated over ranges of angle, then azimuth
  };

  struct Stencil {
    std::array<std::size_t, 4> at;
    std::array<double, 4> weights;
  };
  static Stencil angle_stencil(double mu);
  static Stencil azimuth_stencil(double cosine);
  static std::size_t range_of(double mu);
  double repeated(Way way, double mu_o, double mu_i, double cosine) const;
  double once(Way way, double mu_o, double mu_i, double cosine) const;
  void lay_sampling(ThreadPool& pool, const Eigen::VectorXd& scattered_flux);
  bool scatter_once(Ray& ray, double& weight, Rng& rng) const;
  bool scatter_again(Way way, const Sampling& sampling, Ray& ray, double& weight, Rng& rng) const;

  struct Solved;
  /// Of a layer with that side on top.
  LayerTable(const GradedMedium& graded, const Solved& solved, std::size_t side, ThreadPool& pool);
  void lay(const Solved& solved, std::size_t side, ThreadPool& pool);
  void compare(const Solved& solved, std::size_t side);

  Medium medium_;                            ///< of a graded layer, the thickness
  std::optional<GradedMedium> graded_;       ///< with the side that light enters on top
  std::array<std::vector<float>, 2> table_;  ///< f (mu_o + mu_i): [o][i][azimuth]
  std::vector<Sampling> sampling_;
  double error_ = 0.0;
};

}  // namespace lamina
