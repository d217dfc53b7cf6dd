// SPDX-License-Identifier: GPL-3.0-or-later
// Single scattering anywhere in a stack, in closed form.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "solve/assembly.hpp"
#include "solve/evaluation.hpp"

namespace lamina {

/// Light scattered once in a stack, by a medium with its untruncated phase function or by the facets of a rough
/// boundary. Light arrives at either face of the layer and leaves from either face, along the paths of the delta field.
/// Values between targets are in closed form, so they are exact for narrow peaks too.
class StackSingleScattering {
 public:
  /// For light that enters on `side`. Keeps references into the assembly.
  StackSingleScattering(const Assembly& assembly, Side side, Path path);

  /// BRDF or BTDF in 1/sr between two targets, at all azimuths; `cosines` are those of dphi.
  Eigen::ArrayXd by_media(Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& cosines) const;
  Eigen::ArrayXd by_facets(Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& cosines) const;
  Eigen::ArrayXd operator()(Eigen::Index o, Eigen::Index i, const Eigen::ArrayXd& cosines) const {
    return by_media(o, i, cosines) + by_facets(o, i, cosines);
  }

 private:
  /// Cosines of the targets at the top of the layer, and the shares of the delta field on the way in and out.
  struct Term {
    Eigen::VectorXd mu;
    Eigen::VectorXd in_down;
    Eigen::VectorXd in_up;
    Eigen::VectorXd out_down;
    Eigen::VectorXd out_up;
  };
  struct Medium {
    Term at;
    const Solution::Scatterer* scatterer;
    double weight;
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
