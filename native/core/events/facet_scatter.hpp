// SPDX-License-Identifier: GPL-3.0-or-later
// Scattering of single rays by a rough boundary.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "events/facet_normals.hpp"
#include "events/scattering_surface.hpp"
#include "matter/microfacet.hpp"

namespace lamina {

/// A rough boundary for walks: the facets of RoughSurface, with the same compensation, for single rays. Rays are
/// directions of travel, z up.
class FacetScatter final : public ScatteringSurface {
 public:
  /// `above`: the boundary as light from above meets it.
  FacetScatter(const Facets& facets, const FacetOptics& above);

  /// The smaller width of the facets.
  double alpha() const override { return std::min(facets_.alpha, facets_.across()); }

  double value(const Ray& in, const Ray& out) const override;
  Outcome sample(const Ray& in, Rng& rng) const override;

  /// For the light that meets one facet, without compensation.
  double value_once(const Ray& in, const Ray& out) const override;
  Outcome sample_once(const Ray& in, bool reflects, Rng& rng) const override;

 private:
  /// The energy that single scattering by facets loses for light from one side, tabulated by the square root of the
  /// cosine, with cubic interpolation: the loss bends sharply at cosines similar to alpha. By the azimuth from the
  /// tangent, a sum of cos(2 k azimuth); of isotropic facets the mean alone.
  struct Loss {
    static constexpr int kKnots = 64;
    using Row = std::array<double, kKnots + 1>;
    std::vector<Row> waves;
    double mean = 0.0;     ///< for uniform diffuse light
    double largest = 0.0;  ///< of all directions

    /// `twice`: the cosine of twice the azimuth.
    double operator()(double mu, double twice) const;
    /// The mean over azimuths.
    double mean_at(double mu) const { return std::clamp(interpolated(waves.front(), mu), 0.0, largest); }

   private:
    static double interpolated(const Row& row, double mu);
  };

  /// A ray that one facet reflects or refracts.
  struct ByFacet {
    Ray ray;
    double kept;  ///< share of the light that other facets do not mask, at most 1
  };

  /// With the incident side up.
  double facet_value(const Ray& view, const Ray& out, bool from_below) const;
  /// With the incident side up. `hidden`: Smith's Lambda of the view; `ratio`: of the index beyond to that here.
  ByFacet reflected(const Ray& view, const Ray& normal, double hidden) const;
  ByFacet refracted(const Ray& view, const Ray& normal, double hidden, double ratio) const;
  double density_of(const Ray& normal) const;
  /// Smith's Lambda of a direction on either side.
  double lambda_of(const Ray& ray) const;
  double lost(bool below, const Ray& ray) const;
  /// 1 minus what the facets keep of light from this direction.
  double loss_at(const std::vector<VisibleFacet>& facets, bool below, double mu, double azimuth) const;
  Loss loss_on(bool below) const;
  double ior_of(bool below) const { return optics(below).here; }
  const FacetOptics& optics(bool below) const { return below ? below_ : above_; }

  Facets facets_;
  FacetOptics above_;
  FacetOptics below_;
  bool metal_;
  bool compensate_;
  std::array<Loss, 2> losses_;  ///< above, below
  double compensation_ = 1.0;   ///< share of the lost energy that is added back
  double whole_loss_ = 0.0;     ///< sum over sides of n^2 times the mean loss
};

}  // namespace lamina
