// SPDX-License-Identifier: GPL-3.0-or-later
// The azimuth orders of scattering by matte flakes, such as the sides of fibres.
#pragma once
#include <Eigen/Core>
#include <array>

#include "matter/flakes.hpp"
#include "operators/directions.hpp"
#include "solve/phase_kernel.hpp"

namespace lamina {

/// Heights of flakes' normals in (0, 1), and weights: 8 pi D times the step, for normals of either sign.
struct NormalHeights {
  Eigen::VectorXd cosine;
  Eigen::VectorXd weight;

  explicit NormalHeights(double alpha);
};

/// Scattering by matte flakes between two rays: 4 times the integral of D(m) max(0, m.o) max(0, m.i) over all normals
/// m, where o points along the light that leaves and i towards the light, divided by the extinctions along both rays.
/// As the scattering of mirrors (see FlakeKernel) this takes the place of a phase function of mean 1.
///
/// For normals of one height, max(0, m.w) is a cosine of the azimuth, clamped at 0, whose Fourier coefficients are
/// known. Normals of all azimuths convolve two of them, so that each order of the scattering is a sum over heights of
/// products of two coefficients.
class MatteKernel {
 public:
  MatteKernel(const Flakes& flakes, const Directions& directions);

  /// One order between all directions; 0 between two targets.
  PhaseKernel order(int m) const;

 private:
  Flakes flakes_;
  NormalHeights heights_;
  Eigen::VectorXd mu_;
  Eigen::VectorXd inverse_;  // of the extinction
  Eigen::Index live_;
  Eigen::VectorXd correction_;  // of order 0, by live node
};

/// The same scattering at any directions: a table of orders by the angles of both rays, with cubic interpolation.
class MattePhase {
 public:
  explicit MattePhase(const Flakes& flakes);

  /// Between a ray and others; arguments as for flake_phase.
  Eigen::ArrayXd operator()(double mu_o, const Eigen::ArrayXd& mu_i, double turn, const Eigen::ArrayXd& azimuths) const;

 private:
  struct Place {
    Eigen::Index first;
    std::array<double, 4> weight;
  };
  Place place(double mu) const;

  Flakes flakes_;
  std::array<Eigen::MatrixXd, 2> series_;  // reflection, transmission: [order, angle of one ray and of the other]
};

}  // namespace lamina
