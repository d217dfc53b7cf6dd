// SPDX-License-Identifier: GPL-3.0-or-later
// Single scattering of a pencil beam in one medium, on its way to a face, in closed form.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <functional>
#include <limits>
#include <vector>

#include "lateral/lateral_layer.hpp"

namespace lamina {

/// The integral of attenuation over the optical depth below the face where light leaves, in a layer of optical
/// thickness `tau`. Scattered light is attenuated by `rate` on its way to the face. The beam is attenuated by `beam`,
/// and runs away from the face (`away`) or towards it.
std::complex<double> once_attenuated(std::complex<double> rate, std::complex<double> beam, double tau, bool away);

/// The truncated phase function at a cosine, summed from its moments.
double truncated_phase(const TruncatedMedium& medium, double cosine);

/// Light of a beam along the normal that one medium has scattered once and that leaves through smooth boundaries and
/// other media. If the medium lies next to the face, the flux density near the beam falls as 1 / r and its spectrum as
/// 1 / q, so this light is subtracted from the spectrum and added in closed form. Light that has crossed other media is
/// smooth in r, but in a discretised stack it travels in discrete directions; the difference of `at` and `discretised`
/// corrects the discretisation.
class OnceScatteredBeam {
 public:
  /// The power of the beam at the two faces of the medium, from inside. `towards` runs towards the face where light
  /// leaves, `away` runs away from it.
  struct Beam {
    double away = 0.0;     ///< at the face where light leaves
    double towards = 0.0;  ///< at the other face
  };
  /// Another medium that the light crosses on its way to the face.
  struct Crossed {
    double extinction;  ///< 1/mm
    double thickness;   ///< mm
    double ior;         ///< refractive index relative to the medium that scatters
  };
  /// `passing`: share of light at a cosine in the medium that leaves through the face; light below `critical` does not
  /// leave. Keeps references to `medium` and to its `directions`.
  OnceScatteredBeam(const LateralMedium& medium, const Directions& directions, Beam beam,
                    std::function<double(double mu)> passing, double critical, std::vector<Crossed> crossed = {});

  /// The flux in the discretised stack, with the truncated phase function.
  double discretised(double q, const AzimuthRule& azimuths) const;
  /// The same with fine quadratures, and with the untruncated phase function for backscattering.
  double at(double q) const;
  /// The same with the untruncated phase function for all angles.
  double whole_at(double q) const;

  // The following functions are for light that crosses no other medium.

  /// Flux density times r of whole_at, mm^-1.
  double density_times_radius(double r) const;
  /// The integral of the flux density times r^power over the surface within a radius.
  double moment(int power, double within = std::numeric_limits<double>::infinity()) const;
  /// Flux within the radius r.
  double inside(double r) const { return moment(0, r); }

 private:
  struct Phases {
    std::vector<double> turned;
    std::vector<double> forward;
  };
  double spectrum(double q, const Phases& phases) const;
  /// Optical length and lateral displacement in mm in the crossed media, for a cosine in the scattering medium.
  struct Crossing {
    double optical = 0.0;
    double aside = 0.0;
  };
  Crossing crossing(double mu) const;

  const LateralMedium* medium_;
  const Directions* directions_;  // directions in the medium
  Beam beam_;
  std::function<double(double)> passing_;
  double critical_;
  std::vector<Crossed> crossed_;
  double tau_;
  std::vector<double> mu_;      // fine nodes
  std::vector<double> weight_;  // weights, multiplied by `passing`
  Phases own_;
  Phases truncated_;
};

}  // namespace lamina
