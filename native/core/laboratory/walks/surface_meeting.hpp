// SPDX-License-Identifier: GPL-3.0-or-later
// Scattering of light at a boundary or at the base.
#pragma once
#include "walks/walk_elements.hpp"

namespace lamina {

/// Reflects or refracts light at a smooth boundary or a mirror; a mirror reduces the weight by its reflectance. Returns
/// false if the light is lost.
bool meet_polished(const WalkElements& stack, std::size_t element, Ray& ray, double& weight, Rng& rng);

/// Scatters light at a rough boundary or a Lambert surface. Returns false if the light is lost.
bool scatter_at_surface(const WalkElements::Element& surface, Ray& ray, double& weight, Rng& rng);

/// The radiance that leaves a rough boundary or a Lambert surface along `out`, divided by the square of the index
/// there, for unit irradiance along `in`, in 1/sr.
double leaving_surface(const WalkElements& stack, std::size_t element, const Ray& in, const Ray& out);

}  // namespace lamina
