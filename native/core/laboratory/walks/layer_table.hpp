// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering function of one layer as a table for lookup and sampling.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "events/sphere.hpp"
#include "matter/stack.hpp"
#include "numeric/thread_pool.hpp"

namespace lamina {

/// The scattering function of one layer for light that enters one side, for lookup and sampling. Single scattering is
/// in closed form. Multiple scattering, which is smooth, is a table of the solved layer with cubic interpolation; its
/// knots are denser towards grazing and towards dphi = 0.
class LayerTable {
 public:
  static constexpr std::size_t kAngles = 76;    ///< from the normal to grazing
  static constexpr std::size_t kAzimuths = 64;  ///< from forward to backward

  /// The table of a homogeneous layer, the same for both sides. Throws std::runtime_error if it cannot be solved.
  LayerTable(const Medium& medium, ThreadPool& pool);
  /// The tables of a graded layer for light that enters its top and its bottom, from one solution.
  static std::array<LayerTable, 2> both_sides(const GradedMedium& graded, ThreadPool& pool);

  /// BRDF or BTDF of the layer in its own medium, from the direction `in` to the direction `out`.
  double value(const Ray& in, const Ray& out) const;

  /// The largest error halfway between the table's knots plus the discretisation error of the solution, relative to the
  /// value, for cosines of at least .05.
  double error() const { return error_; }

  /// The share of a ray's light that passes unscattered, and approximately the share that leaves scattered.
  double unscattered(const Ray& in) const;
  double scattered(const Ray& in) const;

  /// Samples the passage of light; false if it is lost. With `first` no light passes unscattered, and the weight is
  /// relative to scattered(in).
  bool cross(Ray& ray, double& weight, bool first, Rng& rng) const;

 private:
  enum Way : std::size_t { kReflected, kPassed };

  /// For light in one range of angles: the shares of multiple scattering by each way and of single scattering, and the
  /// distribution of directions.
  struct Sampling {
    std::array<double, 2> repeated = {};
    double once = 0.0;
    std::array<std::vector<double>, 2> until;  ///< cumulative over [range of angle, azimuth]
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
  /// The table for one side; `graded` has this side on top.
  LayerTable(const GradedMedium& graded, const Solved& solved, std::size_t side, ThreadPool& pool);
  void lay(const Solved& solved, std::size_t side, ThreadPool& pool);
  void compare(const Solved& solved, std::size_t side);

  Medium medium_;                            ///< of a graded layer only tau is used
  std::optional<GradedMedium> graded_;       ///< with the side of entry on top
  std::array<std::vector<float>, 2> table_;  ///< f (mu_o + mu_i): [o][i][azimuth]
  std::vector<Sampling> sampling_;
  double error_ = 0.0;
};

}  // namespace lamina
