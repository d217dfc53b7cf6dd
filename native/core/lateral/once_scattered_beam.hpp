// SPDX-License-Identifier: GPL-3.0-or-later
// A pencil beam scattered once in one medium, on its way to a face, in closed form.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "lateral/lateral_layer.hpp"

namespace lamina {

/// The truncated phase function by its moments.
double truncated_phase(const TruncatedMedium& medium, double cosine);

/// Light of a beam along the normal that one medium has scattered once, on its way to a face through smooth boundaries
/// and other media. If the medium lies next to the face, the flux density falls as 1 / r near the beam and its spectrum
/// as 1 / q: this light is taken off and added in closed form. Light that has crossed other media is smooth in r, but
/// in a discretised stack it comes in discrete directions: the difference of `at` and `discretised` corrects that.
class OnceScatteredBeam {
 public:
  /// What arrives of the beam at the medium's two faces, from the inside of the stack: `towards` runs to the face where
  /// the light leaves, `away` runs from it. `passing` gives, for a cosine in the medium, what leaves through that face.
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
  /// Light of cosines below `critical` does not leave. Keeps references to `medium` and to its `directions`.
  OnceScatteredBeam(const LateralMedium& medium, const Directions& directions, Beam beam,
                    std::function<double(double mu)> passing, double critical, std::vector<Crossed> crossed = {});

  /// The flux as a discretised stack has it, with the truncated phase function.
  double discretised(double q, const AzimuthRule& azimuths) const;
  /// The same with the medium's own phase function where the beam turns back, and fine quadratures.
  double at(double q) const;
  /// With the medium's own phase function everywhere.
  double whole_at(double q) const;

  // The following hold for light that crosses no other medium.

  /// Flux density times r of whole_at, mm^-1.
  double density_times_radius(double r) const;
  /// Flux within the radius r.
  double inside(double r) const;
  /// The integral of the flux density times r^power.
  double moment(int power) const;

 private:
  struct Phases {
    std::vector<double> turned;
    std::vector<double> forward;
  };
  double spectrum(double q, const Phases& phases) const;
  /// Optical length, and length along the surface in mm, of the crossed media at a cosine in the scattering medium.
  struct Crossing {
    double optical = 0.0;
    double aside = 0.0;
  };
  Crossing crossing(double mu) const;

  const LateralMedium* medium_;
  const Directions* directions_;  // in the medium
  Beam beam_;
  std::function<double(double)> passing_;
  double critical_;
  std::vector<Crossed> crossed_;
  double tau_;
  std::vector<double> mu_;      // fine nodes
  std::vector<double> weight_;  // with what passes
  Phases own_;
  Phases truncated_;
};

}  // namespace lamina
