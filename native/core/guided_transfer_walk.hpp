// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "graded_medium.hpp"
#include "scattering_guide.hpp"
#include "walk.hpp"

namespace lamina {

/// The BRDF of a homogeneous slab by a photon walk of the equation of transfer that the tables of the scattering
/// equation guide. A collision at height t is taken to be worth, beyond its own next event,
///   exp(-(tau - t) / mu_o) (kS~)(t; view, ray) + what a diffuse field adds, which falls by the diffusion law:
/// S~ of the slab below the collision, seen through what lies above; for rays upwards, of which the tables know
/// nothing, kS~ is a mean. From each collision several flights with ends are drawn, by the phase function from the ray
/// and from the exit; next event counts at all ends, and the walk goes on from one, resampled by worth. Unbiased
/// whatever the tables say. Throws std::invalid_argument for media that vary with depth.
std::unique_ptr<Walk> make_guided_transfer_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi,
                                                std::shared_ptr<const ScatteringGuide> guide = nullptr);

}  // namespace lamina
