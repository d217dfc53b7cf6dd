// SPDX-License-Identifier: GPL-3.0-or-later
// Light scattered once anywhere in a stack, in closed form.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "solve/assembly.hpp"
#include "solve/evaluation.hpp"

namespace lamina {

/// Light scattered once, by a medium with its true phase function or by the facets of a rough boundary: it
/// arrives at either face of the layer and leaves by either, on the paths of the delta field. In closed form
/// between targets, however narrow.
class StackSingleScattering {
 public:
  /// Of light that enters on `side`; keeps references into the assembly.
  StackSingleScattering(const Assembly& assembly, Side side, Path path);

  /// BRDF or BTDF in 1/sr between two targets, at all azimuths; `cosines` are those of dphi.
  Eigen::ArrayXd by_media(Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& cosines) const;
  Eigen::ArrayXd by_facets(Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& cosines) const;
  Eigen::ArrayXd operator()(Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& cosines) const {
    return by_media(o, i, cosines) + by_facets(o, i, cosines);
  }

 private:
  /// Cosines of the targets where the layer begins, and what the delta field brings there and takes away.
  struct Term {
    Eigen::VectorXd mu;
    Eigen::VectorXd in_down;
    Eigen::VectorXd in_up;
    Eigen::VectorXd out_down;
    Eigen::VectorXd out_up;
  };
  struct Medium {
    Term at;
    double tau;
    double weight;
    const PhaseFunction* phase;
  };
  struct Facet {
    Term at;
    Eigen::VectorXd mu_below;
    const RoughSurface* surface;
  };
  std::vector<Medium> media_;
  std::vector<Facet> facets_;
};

}  // namespace lamina
