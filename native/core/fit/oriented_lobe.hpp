// SPDX-License-Identifier: GPL-3.0-or-later
// The lobe of a Glossy BSDF of Cycles (GGX facets, height-correlated Smith masking, no Fresnel) with any tangent and a
// normal that tilts in any direction, for one view.
#pragma once

#include "fit/moving_lobe.hpp"

#include <Eigen/Core>

namespace lamina {

/// What the table holds of a lobe at one view. The lobe's tangent, its narrow axis, is t radians from the layer's
/// tangent. (a cos 2t, a sin 2t) has no jump where the tangent has turned by half a turn, nor where the lobe is round.
struct OrientedShape {
  double roughness = 1.0;  ///< in (0, 1]; its square is the geometric mean of the two widths alpha
  double along = 0.0;      ///< a cos 2t, with the anisotropy a in [0, 1)
  double across = 0.0;     ///< a sin 2t
  double tilt = 0.0;       ///< k: the normal is N + k I + l N x I, normalised
  double aside = 0.0;      ///< l
};

class OrientedLobe {
 public:
  /// `phi_o`: azimuth of the viewer from the layer's tangent. The frame of all directions is that of LightDirections:
  /// the viewer is at (sin theta_o, 0, cos theta_o).
  OrientedLobe(const OrientedShape& shape, double mu_o, double phi_o);

  /// f * |cos theta_i| in 1/sr for each direction; 0 below the tilted horizon, and if the viewer is below it.
  void values(const LightDirections& light, Eigen::Ref<Eigen::VectorXd> out) const;

  /// The directional albedo, the integral of `values` over the light above the surface, by a quadrature over visible
  /// normals (Heitz 2018).
  [[nodiscard]] double albedo() const;

 private:
  using Vector = Eigen::Vector3d;
  /// Normals on the disk that a stretched view sees, along a line at `t1`.
  struct Chord {
    Vector first;  ///< stretched frame of the disk
    Vector second;
    Vector view;
    double t1;
    double half;
    double lift;
  };
  /// The share of light that the normal at `along` in [-1, 1] reflects unmasked; at most 0 if the light is below a
  /// horizon.
  [[nodiscard]] double reflected(const Chord& chord, double along) const;
  [[nodiscard]] double lambda(const Vector& direction) const;

  double alpha_x_;
  double alpha_y_;
  Eigen::Matrix3d axes_;  ///< rows: tangent, bitangent and tilted normal
  Vector view_;           ///< in these axes
  Vector upright_;        ///< the surface's normal in these axes
  double lambda_view_ = 0.0;
};

}  // namespace lamina
