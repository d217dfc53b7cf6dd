// SPDX-License-Identifier: GPL-3.0-or-later
// The azimuth orders of scattering by flakes, in closed form.
#pragma once
#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "matter/flakes.hpp"
#include "operators/directions.hpp"
#include "solve/matte_kernel.hpp"
#include "solve/phase_kernel.hpp"

namespace lamina {

/// Scattering by mirrors between two rays: pi F(h.w) D(h), divided by the extinctions along both rays. With optical
/// cosines (see TruncatedMedium) this takes the place of a phase function of mean 1. `turn` -1: the rays cross the
/// layer in opposite senses, 1: in the same sense; `azimuth`: the cosine of dphi, 1 forward.
double flake_phase(const Flakes& flakes, double mu_o, double mu_i, double turn, double azimuth);

/// The azimuth orders of scattering by flakes between directions and live nodes; of matte flakes see MatteKernel. Of
/// mirrors these are the orders of flake_phase. With x = cos(dphi), D is a rational function,
/// (a (N - Q x) / (P - Q x))^2 / pi, and 4 c^2 = N - Q x for the cosine c at the flake. The Fresnel factor of a metal
/// is fitted by f + sum of w / (c^2 + t), with errors up to 4e-4 at grazing incidence and 2e-4 elsewhere. The
/// reflectance of films takes more poles. Its relative errors are up to 4e-4 as long as index times thickness is
/// below 1.2 wavelengths and no index is below that of the binder; the constructor throws std::runtime_error for large
/// ones. The Fourier coefficients of each term are then geometric.
///
/// The scattering between nearly equal directions depends on the azimuth of their difference, even for small
/// differences, so order m has a cusp |d| exp(-m k |d|) at equal cosines, d their difference, which nodes integrate
/// with an error. The diagonal corrects this error, which is known in order 0 from the norm of white flakes. Flakes
/// that turn light so little are met edge-on, where metals reflect all. The order 0 of flakes with films has their
/// norm, so that the misfit of their reflectance neither adds nor takes light.
class FlakeKernel {
 public:
  FlakeKernel(const Flakes& flakes, const Directions& directions);

  /// One order between all directions; 0 between two targets.
  PhaseKernel order(int m) const;

 private:
  /// Coefficients by direction and live node: of r^m, of m r^m, and of q^m for each term of the Fresnel fit. Every q is
  /// below r: where r^m is nothing, the order vanishes. High orders have few other elements, so that sort() puts all
  /// tables but `steady` into one column, largest r first.
  struct Part {
    Eigen::ArrayXXd log_r;
    Eigen::ArrayXXd flat;
    Eigen::ArrayXXd rising;
    Eigen::ArrayXXd steady;  ///< of order 0 alone
    std::vector<Eigen::ArrayXXd> log_q;
    std::vector<Eigen::ArrayXXd> share;
    std::vector<Eigen::Index> place;  ///< of the elements in a matrix, set by sort()

    void sort();
  };
  Eigen::MatrixXd order_of(const Part& part, int m) const;

  std::shared_ptr<const MatteKernel> matte_;  // null for mirrors
  Eigen::Index targets_;
  std::array<Part, 2> parts_;   // reflection, transmission
  Eigen::VectorXd correction_;  // of order 0, by live node
  Eigen::VectorXd misfit_;      // of order 0 with films, by live node
  Eigen::VectorXd cusp_;        // k times the distance of nodes
};

}  // namespace lamina
