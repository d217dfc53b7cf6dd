// SPDX-License-Identifier: GPL-3.0-or-later
// Kinds of lobes whose shapes are fitted: the numbers that a table holds of a lobe, and the unknowns of the fit.
#pragma once

#include "fit/moving_lobe.hpp"

#include <Eigen/Core>

#include <vector>

namespace lamina {

class LobeFamily {
 public:
  LobeFamily() = default;
  LobeFamily(const LobeFamily&) = delete;
  LobeFamily& operator=(const LobeFamily&) = delete;
  virtual ~LobeFamily() = default;

  /// Of one lobe: unknowns; the last of them tilt the normal and have no effect at normal incidence.
  [[nodiscard]] virtual Eigen::Index unknowns() const = 0;
  [[nodiscard]] virtual Eigen::Index tilts() const = 0;
  /// What the table holds, as many numbers as unknowns.
  [[nodiscard]] virtual Eigen::VectorXd shape(const double* p) const = 0;
  [[nodiscard]] virtual Eigen::VectorXd unknowns_of(const double* shape) const = 0;
  /// f * |cos theta_i| of the light for a view whose azimuth is `phi_o` from the layer's tangent.
  virtual void values(const double* p, double mu_o, double phi_o, const LightDirections& light,
                      Eigen::Ref<Eigen::VectorXd> out) const = 0;
  /// Moves unknowns into their ranges at this view.
  virtual void clamp(double* p, double mu_o) const = 0;
  /// Unknowns to begin with, a ladder from narrow to wide. `retro`: with lobes about the viewer, of families that have
  /// them.
  [[nodiscard]] virtual std::vector<Eigen::VectorXd> starts(bool retro) const = 0;
  /// The unknowns that a mirror at the plane of incidence changes in sign.
  [[nodiscard]] virtual std::vector<Eigen::Index> odd() const = 0;
  /// True if lobes are round at normal incidence.
  [[nodiscard]] virtual bool is_round_at_normal() const = 0;
};

/// Lobes of isotropic stacks, which are symmetric about the plane of incidence: LobeShape. Unknowns: ln alpha; half
/// the logarithm of alpha_x / alpha_y; k, or 100 + ln k for a lobe near the viewer.
const LobeFamily& moving_family();

/// Lobes of any tangent: OrientedShape. Unknowns: ln alpha; s cos 2t, s sin 2t with s half the logarithm of the ratio
/// of wide and narrow width; k; l.
const LobeFamily& oriented_family();

}  // namespace lamina
