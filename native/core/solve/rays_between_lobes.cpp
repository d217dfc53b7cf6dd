// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/rays_between_lobes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "matter/single_scattering_shape.hpp"
#include "solve/moments_behind_lobes.hpp"

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using std::numbers::pi;

/// Degree of the polynomials that few rays integrate, see FacetRays.
constexpr int kFewRays = 4;

}  // namespace

/// Rays in a medium: cosines, cosines of the azimuth from that of the beam, and shares of the beam's flux at the top
/// going down and at the bottom going up.
struct RaysBetweenLobes::RaySet {
  std::vector<double> mu;
  std::vector<double> azimuth;
  std::vector<double> down;
  std::vector<double> up;

  void add(double cosine, double around, double at_top, double at_bottom) {
    mu.push_back(cosine);
    azimuth.push_back(around);
    down.push_back(at_top);
    up.push_back(at_bottom);
  }
};

/// A unit beam along a target, at a medium.
struct RaysBetweenLobes::Bundle {
  RaySet specular;  // one ray
  RaySet lobes;
};

RaysBetweenLobes::Bundle RaysBetweenLobes::bundle(std::size_t scatterer, Index target, bool leaving, int degree) const {
  // Fainter rays, in shares of the beam, are left out. Many of them make up a tail, so more rays are fainter.
  const double faintest = 1e-7 * std::pow(static_cast<double>(kFewRays) / degree, 2);
  const Solution& solution = assembly_.solution();
  const std::size_t layer = solution.scatterers()[scatterer].layer;
  const Directions& here = assembly_.directions()[layer];
  const std::vector<DeltaField::Arrival>& beams = assembly_.deltas().from_above;
  const Index at = here.nodes + target;
  Bundle all;
  all.specular.add(here.mu[here.live + target], 1.0, beams[layer].down[at], beams[layer].up[at]);
  const std::size_t own = section_of(solution, layer);
  for (const bool from_above : {true, false}) {
    if ((from_above && own == 0) || (!from_above && own == solution.boundaries().size())) {
      continue;
    }
    const Solution::Boundary& boundary = solution.boundaries()[from_above ? own - 1 : own];
    const RoughSurface& surface = *boundary.surface;
    const Directions& gap = assembly_.directions()[from_above ? boundary.layer + 1 : boundary.layer];
    const std::vector<FacetRays> lobes = surface.rays_on(solution.direction_set(), degree);
    for (std::size_t entering = 0; entering < lobes.size(); ++entering) {
      const Directions& outside = assembly_.directions()[boundary.layer + entering];
      const double mu = outside.mu[outside.live + target];
      const double share = (entering == 0 ? beams[boundary.layer].down : beams[boundary.layer].up)[at];
      if (!(share > 0.0 && mu > 0.0)) {
        continue;
      }
      Rays reflected;
      Rays transmitted;
      lobes[entering].scatter(mu, reflected, transmitted);
      const Rays& rays = (entering == 0) == from_above ? transmitted : reflected;
      const ArrayXd leaves = Eigen::Map<const ArrayXd>(rays.mu.data(), static_cast<Index>(rays.mu.size()));
      const auto in_gap = [&](std::size_t k) -> ArrayXd {
        return leaves.unaryExpr([&](double m) { return refracted_cosine(m, gap.ior, assembly_.directions()[k].ior); });
      };
      const DeltaField field = sections_.field(own, in_gap);
      const auto& arrival = (from_above ? field.from_above : field.from_below)[layer - sections_.first_layer(own)];
      const ArrayXd arriving = in_gap(layer);
      for (Index k = 0; k < leaves.size(); ++k) {
        const auto ray = static_cast<std::size_t>(k);
        const double whole = share * rays.share[ray] * surface.view_weight(leaving ? mu : leaves[k]);
        if (whole > faintest && arriving[k] > 0.0) {
          all.lobes.add(arriving[k], std::clamp(rays.azimuth[ray], -1.0, 1.0), whole * arrival.down[k],
                        whole * arrival.up[k]);
        }
      }
    }
  }
  return all;
}

ArrayXd RaysBetweenLobes::pairs(std::size_t scatterer, const RaySet& out, const RaySet& in, const ArrayXd& dphi) const {
  const Solution::Scatterer& medium = assembly_.solution().scatterers()[scatterer];
  const TruncatedMedium& optics = medium.medium;
  const double weight = 0.25 / pi * optics.single_scattering_albedo() / (medium.ior * medium.ior);
  const auto array = [](const std::vector<double>& list) {
    return Eigen::Map<const ArrayXd>(list.data(), static_cast<Index>(list.size()));
  };
  const auto sine = [](const ArrayXd& cosine) -> ArrayXd { return (1.0 - cosine.square()).max(0.0).sqrt(); };
  const ArrayXd forward = dphi.cos();
  const ArrayXd sideways = dphi.sin();
  const ArrayXd along = array(in.azimuth);
  const ArrayXd aside = sine(along);
  ArrayXd sum = ArrayXd::Zero(dphi.size());
  for (std::size_t r = 0; r < out.mu.size(); ++r) {
    const double mu_o = out.mu[r];
    const double along_o = out.azimuth[r];
    const double aside_o = std::sqrt(1.0 - along_o * along_o);
    const auto add = [&](const ArrayXd& share, double turn) {
      // Each ray stands for its mirror image in the plane of incidence, too. All pairs of a ray follow one another,
      // because phase_of computes less for equal cosines.
      const Index images = 4 * dphi.size();
      ArrayXd mu(images * (share != 0.0).count());
      ArrayXd azimuths(mu.size());
      std::vector<double> weights;  // of the rays with a share
      Index pair = 0;
      for (Index s = 0; s < share.size(); ++s) {
        if (share[s] == 0.0) {
          continue;
        }
        const double mu_i = in.mu[static_cast<std::size_t>(s)];
        const double once = (turn < 0.0 ? single_reflection : single_transmission)(optics.optical(mu_o),
                                                                                   optics.optical(mu_i), optics.tau);
        weights.push_back(0.25 * weight * (share[s] * once));
        for (const double side_o : {aside_o, -aside_o}) {
          for (const double side : {aside[s], -aside[s]}) {
            const double cosine = along_o * along[s] - side_o * side;
            const double other = side_o * along[s] + along_o * side;
            for (Index p = 0; p < dphi.size(); ++p, ++pair) {
              mu[pair] = mu_i;
              azimuths[pair] = forward[p] * cosine - sideways[p] * other;
            }
          }
        }
      }
      const ArrayXd phase = medium.phase_of(mu_o, mu, turn, azimuths);
      pair = 0;
      for (const double of_ray : weights) {
        for (Index image = 0; image < 4; ++image, pair += dphi.size()) {
          sum += of_ray * phase.segment(pair, dphi.size());
        }
      }
    };
    add(out.down[r] * array(in.down) + out.up[r] * array(in.up), -1.0);
    add(out.down[r] * array(in.up) + out.up[r] * array(in.down), 1.0);
  }
  return sum;
}

/// The degree of polynomials in azimuth and cosine that represent a phase function.
int RaysBetweenLobes::degree_of(const Solution::Scatterer& scatterer) const {
  constexpr int kMost = 256;
  if (scatterer.matte || scatterer.medium.flakes) {
    return kFewRays;
  }
  int degree = kFewRays;
  for (int l = degree; l <= kMost; ++l) {
    degree = std::abs(scatterer.phase.moment(l)) > assembly_.solution().resolution().azimuth_tolerance ? l : degree;
  }
  return degree;
}

ArrayXd RaysBetweenLobes::value(Index o, Index i, const ArrayXd& dphi, bool precise) const {
  const Solution& solution = assembly_.solution();
  ArrayXd sum = ArrayXd::Zero(dphi.size());
  for (std::size_t k = 0; k < solution.scatterers().size(); ++k) {
    const Solution::Scatterer& scatterer = solution.scatterers()[k];
    if (scatterer.medium.single_scattering_albedo() == 0.0) {
      continue;
    }
    const Bundle in = bundle(k, i, false, kFewRays);
    const Bundle out = bundle(k, o, true, kFewRays);
    sum += pairs(k, out.lobes, in.lobes, dphi);
    // Two specular rays are in closed form, see StackSingleScattering. Between a specular ray and a lobe, all peaks of
    // the phase function must be met; two lobes blur them.
    const int degree = precise ? degree_of(scatterer) : kFewRays;
    const bool more = degree > kFewRays;
    sum += pairs(k, out.specular, more ? bundle(k, i, false, degree).lobes : in.lobes, dphi);
    sum += pairs(k, more ? bundle(k, o, true, degree).lobes : out.lobes, in.specular, dphi);
  }
  return sum;
}

}  // namespace lamina
