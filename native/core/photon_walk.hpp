// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "graded_medium.hpp"
#include "walk.hpp"

namespace lamina {

/// The BRDF of a slab that may vary with depth by the equation of transfer: a photon's walk with next-event
/// estimation, its weight and Russian roulette. What the walks of the scattering equation fall back to.
class PhotonWalk final : public Walk {
 public:
  PhotonWalk(const GradedMedium& medium, double mu_o, double mu_i, double dphi);

  double sample(Rng& rng, std::uint64_t& events) const override;

 private:
  GradedMedium medium_;
  double mu_o_;
  double mu_i_;
  double out_x_;
  double out_y_;
};

}  // namespace lamina
