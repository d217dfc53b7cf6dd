// SPDX-License-Identifier: GPL-3.0-or-later
// The lobe of a Glossy BSDF of Cycles (GGX facets, height-correlated Smith masking, no Fresnel) whose width, anisotropy
// and tilt are chosen for one view. All of it is symmetric about the plane of incidence.
#pragma once

#include <Eigen/Core>

namespace lamina {

/// What the node's sockets hold at one view.
struct LobeShape {
  double roughness = 1.0;   ///< in (0, 1]; its square is the geometric mean of the two widths alpha
  double anisotropy = 0.0;  ///< in (-1, 1); positive: narrow in the plane of incidence and wide across it
  double tilt = 0.0;        ///< k: the normal is N + k I, normalised
};

/// Directions of the light above the surface. The viewer is at (sin theta_o, 0, cos theta_o).
struct LightDirections {
  Eigen::ArrayXd x;
  Eigen::ArrayXd y;
  Eigen::ArrayXd z;

  /// The product grid of cosines and azimuths, cosines major; azimuth 0 is forward.
  LightDirections(const Eigen::Ref<const Eigen::VectorXd>& mu, const Eigen::Ref<const Eigen::VectorXd>& dphi);
};

class MovingLobe {
 public:
  MovingLobe(const LobeShape& shape, double mu_o);

  /// f * |cos theta_i| in 1/sr for each direction; 0 below the tilted horizon, and if the viewer is below it.
  void values(const LightDirections& light, Eigen::Ref<Eigen::VectorXd> out) const;

  /// The directional albedo, the integral of `values` over the light above the surface, by a quadrature over visible
  /// normals (Heitz 2018).
  [[nodiscard]] double albedo() const;

 private:
  /// A line of visible normals on the disk, in the plane of incidence.
  struct Chord {
    double t1;
    double half;
    double stretched_x;
    double stretched_z;
    double lift;
  };
  /// The share of light that the normal at `along` in [-1, 1] reflects unmasked; at most 0 if the light is below a
  /// horizon.
  [[nodiscard]] double reflected(const Chord& chord, double along) const;
  [[nodiscard]] double lambda(double x, double y, double z) const;

  double alpha_x_;
  double alpha_y_;
  double sin_tilt_;
  double cos_tilt_;
  double view_x_;  // of the viewer, in the frame of the tilted normal
  double view_z_;
  double lambda_view_;
};

}  // namespace lamina
