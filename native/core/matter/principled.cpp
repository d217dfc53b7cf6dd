// SPDX-License-Identifier: GPL-3.0-or-later
#include "matter/principled.hpp"

#include <algorithm>
#include <cmath>

#include "matter/dielectric_rise.hpp"

namespace lamina {
namespace {

double mix(double a, double b, double share) { return a + share * (b - a); }

/// The relative index and F0 of the specular lobe: the socket `specular` scales F0.
DielectricLobe specular_lobe(const PrincipledSockets& sockets) {
  double eta = sockets.ior;
  double f0 = f0_from_index(eta);
  if (sockets.specular != 0.5) {
    f0 = std::min(1.0, 2.0 * sockets.specular * f0);
    eta = sockets.ior < 1.0 ? 1.0 / index_from_f0(f0) : index_from_f0(f0);
  }
  return {eta, f0, sockets.roughness};
}

/// The mean reflectance for uniform diffuse light: the fit of Kulla and Conty (2017), which Cycles uses.
double mean_reflectance(double eta) {
  return eta < 1.0 ? 0.997118 + eta * (0.1014 - eta * (0.965241 + eta * 0.130607))
                   : (eta - 1.0) / (4.08567 + 1.00071 * eta);
}

/// Light scattered repeatedly by facets of mean reflectance `mean` and mean albedo `albedo`, relative to one
/// reflection.
double repeated_reflectance(double mean, double albedo) { return mean * albedo / (1.0 - mean * (1.0 - albedo)); }

/// 1 plus the light that facets scatter repeatedly, at an albedo of single scattering.
double gained(double repeated, double albedo) { return 1.0 + repeated * (1.0 - albedo) / albedo; }

}  // namespace

DielectricLobe::DielectricLobe(double index, double normal, double roughness)
    : eta(index), f0(normal), facets(facet_albedo(roughness)), rise(fresnel_rise(roughness, index)) {
  const double own = f0_from_index(eta);
  const double share = std::clamp((mean_reflectance(eta) - own) / (1.0 - own), 0.0, 1.0);
  repeated = repeated_reflectance(mix(f0, 1.0, share), facets.mean);
}

double DielectricLobe::reflectance(double cosine) const { return mix(f0, 1.0, dielectric_rise(cosine, eta)); }

double DielectricLobe::gain(double mu) const { return gained(repeated, facets.directional.at(mu)); }

double DielectricLobe::albedo(double mu) const {
  return facets.directional.at(mu) * gain(mu) * mix(f0, 1.0, rise.at(mu));
}

PrincipledLaw::PrincipledLaw(const PrincipledSockets& sockets)
    : sockets_(sockets),
      lobe_(specular_lobe(sockets)),
      coat_(sockets.coat_ior, f0_from_index(sockets.coat_ior), sockets.coat_roughness),
      metal_rise_(schlick_rise(sockets.roughness)),
      metal_repeated_(repeated_reflectance(mix(sockets.color, 1.0, 1.0 / 21.0), lobe_.facets.mean)) {
  if (has_coat()) {
    coat_share_ = facet_share(sockets.coat_roughness, [this](double cosine) { return coat_.reflectance(cosine); });
  }
}

std::vector<double> PrincipledLaw::key() const {
  const PrincipledSockets& s = sockets_;
  return {s.color, s.metallic, s.roughness, s.ior, s.specular, s.coat, s.coat_roughness, s.coat_ior};
}

double PrincipledLaw::reflectance(double cosine) const {
  const double metal = mix(sockets_.color, 1.0, std::pow(1.0 - std::min(1.0, cosine), 5.0));
  const double dielectric = lobe_.eta == 1.0 ? 0.0 : lobe_.reflectance(cosine);
  return mix(dielectric, metal, sockets_.metallic);
}

double PrincipledLaw::lobe_weight(double mu) const {
  // Metal and dielectric scatter repeatedly with factors of their own: their mean by albedo is exact in albedo.
  const double metal = sockets_.metallic * mix(sockets_.color, 1.0, metal_rise_.at(mu));
  const double dielectric = lobe_.eta == 1.0 ? 0.0 : (1.0 - sockets_.metallic) * mix(lobe_.f0, 1.0, lobe_.rise.at(mu));
  const double whole = metal + dielectric;
  const double of_metal = gained(metal_repeated_, lobe_.facets.directional.at(mu));
  const double gain = whole > 0.0 ? (metal * of_metal + dielectric * lobe_.gain(mu)) / whole : 1.0;
  return below_coat(mu) * gain;
}

double PrincipledLaw::diffuse(double mu) const {
  const double passed = lobe_.eta == 1.0 ? 1.0 : std::max(0.0, 1.0 - lobe_.albedo(mu));
  return below_coat(mu) * (1.0 - sockets_.metallic) * passed * sockets_.color;
}

double PrincipledLaw::coat(double mu) const {
  return has_coat() ? sockets_.coat * coat_.gain(mu) * coat_.reflectance(mu) * coat_share_.at(std::sqrt(mu)) : 0.0;
}

double PrincipledLaw::below_coat(double mu) const {
  return has_coat() ? std::max(0.0, 1.0 - sockets_.coat * coat_.albedo(mu)) : 1.0;
}

}  // namespace lamina
