// SPDX-License-Identifier: GPL-3.0-or-later
// Scattering of single rays by a measured base.
#pragma once
#include <memory>

#include "events/scattering_surface.hpp"
#include "matter/base.hpp"

namespace lamina {

/// A measured base for walks. Directions are drawn from a mixture of Lambert's cosine and the visible normals of GGX
/// facets that are somewhat wider than the narrowest peak; the weight is the value over the density of the mixture.
class MeasuredScatter final : public ScatteringSurface {
 public:
  MeasuredScatter(const Base& base, double ior_above);

  double alpha() const override { return facets_.alpha; }
  double value(const Ray& in, const Ray& out) const override;
  Outcome sample(const Ray& in, Rng& rng) const override;
  double value_once(const Ray& in, const Ray& out) const override { return value(in, out); }
  Outcome sample_once(const Ray& in, bool reflects, Rng& rng) const override;

 private:
  double reflected(const Ray& view, const Ray& out, const Ray& half) const;

  std::shared_ptr<const MeasuredReflection> measured_;
  Facets facets_;  // of the mixture
  double ior_;
};

}  // namespace lamina
