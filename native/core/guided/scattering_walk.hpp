// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses among the walks that estimate one BRDF value of a slab.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "matter/graded_medium.hpp"
#include "walks/walk.hpp"

namespace lamina {

/// Walks that estimate one BRDF value of a slab, on a Lambert surface or not, by the scattering equation, and the
/// choice among them.
struct ScatteringWalk {
  std::unique_ptr<Walk> walk;
  std::string name;                 ///< one of scattering_walk_names()
  std::uint64_t pilot_samples = 0;  ///< spent on the choice, and discarded
  std::uint64_t pilot_events = 0;
};

/// A walk by its name, or "auto": the isotropic walk where scattering is isotropic; else the guided walk that does best
/// in a pilot of a fixed number of samples - residual, or of the equation of transfer, in a homogeneous medium over
/// nothing, guided elsewhere - or the transfer walk where no guided one is clearly better. The choice goes by variance
/// times a fixed cost of each sort of event, never by the clock, so that it depends on nothing but the arguments.
/// Throws std::invalid_argument for an unknown name.
ScatteringWalk make_scattering_walk(const GradedMedium& medium, double mu_o, double mu_i, double dphi,
                                    const std::string& name, std::uint64_t seed);

/// The BRDF's walk by any of the names.
std::vector<std::string> scattering_walk_names();

}  // namespace lamina
