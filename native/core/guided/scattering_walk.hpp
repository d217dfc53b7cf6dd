// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses a walk for one BRDF value of a slab.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// A walk of the scattering equation for one BRDF value of a slab, over nothing or on a Lambert surface.
struct ScatteringWalk {
  std::unique_ptr<Walk> walk;
  std::string name;                 ///< one of scattering_walk_names()
  std::uint64_t pilot_samples = 0;  ///< spent on the choice and discarded
  std::uint64_t pilot_events = 0;
};

/// The walk with this name, or for "auto" the best one: the isotropic walk for isotropic scattering; else a guided walk
/// (the residual walk or the guided transfer walk in a homogeneous medium over nothing, the guided walk elsewhere), or
/// the transfer walk if no guided walk is clearly better. A pilot with a fixed number of samples compares variance
/// times fixed costs of events. It never measures time, so the choice depends on the arguments alone. Throws
/// std::invalid_argument for an unknown name.
ScatteringWalk make_scattering_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi,
                                    const std::string& name, std::uint64_t seed);

/// The names that make_scattering_walk accepts.
std::vector<std::string> scattering_walk_names();

}  // namespace lamina
