// SPDX-License-Identifier: GPL-3.0-or-later
// Single scattering of an oblique pencil beam in the medium next to a face.
#pragma once
#include <functional>
#include <vector>

#include "lateral/flux_by_distance.hpp"
#include "lateral/lateral_layer.hpp"

namespace lamina {

/// A way of the unscattered beam through a medium.
struct BeamWay {
  double start;  ///< distance from the point of entry where the way begins, mm
  double flux;   ///< where the way begins
  bool away;     ///< from the face where light leaves, or towards it
};

/// Light of an oblique beam that one medium has scattered once, by the truncated phase function, and that leaves
/// through smooth boundaries. Its density is singular where the beam leaves, so its spectrum falls slowly and
/// oscillates with the distance of these places. A discretised stack cannot resolve this light at high frequencies: it
/// is subtracted from the spectrum and added by distance.
class ObliqueScattering {
 public:
  /// `passing`: share of light at a cosine in the medium that leaves through the face; light below `critical` does not
  /// leave. Keeps references to `medium` and to its `directions`.
  ObliqueScattering(const LateralMedium& medium, const Directions& directions, std::vector<BeamWay> ways,
                    std::function<double(double mu)> passing, double critical);

  /// The flux in the discretised stack.
  double discretised(double q, const AzimuthRule& azimuths) const;
  /// The flux by distance, with the total of the discretised stack.
  FluxByDistance by_distance() const;

 private:
  double phase(double mu, bool away, double azimuth_cosine) const;
  double farthest() const;

  const LateralMedium* medium_;
  const Directions* directions_;  // directions in the medium
  std::vector<BeamWay> ways_;
  std::function<double(double)> passing_;
  double critical_;
  double mu_;    // of the beam in the medium
  double sine_;  // of the same angle
};

}  // namespace lamina
