// SPDX-License-Identifier: GPL-3.0-or-later
// A wide lobe as matrices by azimuth order, from its values between nodes.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "matter/microfacet.hpp"
#include "numeric/thread_pool.hpp"
#include "operators/directions.hpp"
#include "rough/lobe_columns.hpp"

namespace lamina {

/// A reflected lobe between one cosine and many directions, in 1/sr; symmetric. See RoughSurface::values.
using LobeValues = std::function<Eigen::ArrayXXd(double mu, const FacetPairs& pairs)>;

/// The reflected lobe of facets on the nodes of one medium, from its values. Where the nodes resolve a lobe, its values
/// converge as fast as polynomials, and high azimuth orders fall off as they must. The sums over rays of LobeOperator
/// take longer and leave noise there, but they suit lobes of any width.
class ResolvedLobe {
 public:
  /// Facets of width `alpha` in the medium of index `ior`.
  ResolvedLobe(LobeValues lobe, DirectionSet set, double ior, double alpha, int orders);

  /// The matrices by order, [live node, live node].
  std::vector<Eigen::MatrixXd> on_nodes(ThreadPool& pool) const;
  /// The error of the interpolation of these matrices at every fourth of finer nodes, relative to the mean over
  /// azimuths. Pairs with a grazing direction do not count: the mean over azimuths has a logarithm there.
  double interpolation_error(const std::vector<Eigen::MatrixXd>& matrices, ThreadPool& pool) const;
  /// The columns for the targets of the medium.
  std::shared_ptr<const LobeColumns> from_targets(const Directions& directions, ThreadPool& pool) const;

 private:
  /// A quadrature over azimuths 0 to pi for cos(m phi) times lobes.
  struct Azimuths {
    Eigen::ArrayXd cosines;
    Eigen::MatrixXd waves;  ///< weight * cos(m phi), [azimuth, order]

    Azimuths(double narrowest, int orders);
  };
  Eigen::MatrixXd between(double mu, double common, Eigen::Index nodes) const;

  LobeValues lobe_;
  DirectionSet set_;
  Directions nodes_;
  Eigen::VectorXd common_;  ///< C of Directions at the nodes
  Azimuths azimuths_;
  std::unique_ptr<LastColumns> last_ = std::make_unique<LastColumns>();
};

}  // namespace lamina
