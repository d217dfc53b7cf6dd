// SPDX-License-Identifier: GPL-3.0-or-later
// Specular light in a stack with anisotropic facets: from outside to the layers that scatter it, and the facets'
// single scattering between two such paths.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "operators/delta_field.hpp"
#include "oriented/oriented_solution.hpp"

namespace lamina {

/// The specular light of the whole stack for cosines in air.
Deltas specular_light(const OrientedSolution& solution, const Eigen::VectorXd& mu);

/// The paths of light from some directions outside. By reciprocity the same numbers hold for light to them.
class SpecularPaths {
 public:
  /// A direction of travel outside, from above or from below.
  struct Arrived {
    Eigen::Index target = 0;  ///< its cosine, of those of the constructor
    double phi = 0.0;         ///< in the frame of the solve
    bool below = false;
    double cosine = std::cos(phi);
    double sine = std::sin(phi);
  };
  struct Arrival {
    double down;  ///< share at the top of a layer
    double up;    ///< share at its bottom
  };

  /// `cosines`: in air.
  SpecularPaths(const OrientedSolution& solution, const Eigen::VectorXd& cosines);

  const std::vector<Directions>& gaps() const { return gaps_; }
  Arrival arrival(const Arrived& beam, std::size_t layer) const {
    const DeltaField::Arrival& here = (beam.below ? deltas_.from_below : deltas_.from_above)[layer];
    return {here.down[beam.target], here.up[beam.target]};
  }
  Heading heading(const Arrived& beam, std::size_t gap) const {
    return Heading::of(gaps_[gap].mu[gaps_[gap].live + beam.target], beam.cosine, beam.sine);
  }
  /// Light that facets of a layer, or of the base, scatter once from `in` to `out`, in 1/sr.
  double by_facets(const Arrived& out, const Arrived& in, std::size_t layer) const;
  /// Calls add(from, to, share) for each pair of a surface's faces that light between the two directions meets.
  template <class Add>
  void over_faces(std::size_t layer, const Arrived& out, const Arrived& in, const Add& add) const {
    const bool is_base = layer == solution_->stack().layers.size();
    const Arrival leaving = arrival(out, layer);
    const Arrival arriving = arrival(in, layer);
    for (const Face from : {Face::kTop, Face::kBottom}) {
      for (const Face to : {Face::kTop, Face::kBottom}) {
        const double share =
            (to == Face::kTop ? leaving.down : leaving.up) * (from == Face::kTop ? arriving.down : arriving.up);
        if (share > 0.0 && !(is_base && (from == Face::kBottom || to == Face::kBottom))) {
          add(from, to, share);
        }
      }
    }
  }

 private:
  const OrientedSolution* solution_;
  std::vector<Directions> gaps_;
  DeltaField deltas_;
};

}  // namespace lamina
