// SPDX-License-Identifier: GPL-3.0-or-later
// The glossy lobes of a rough boundary as matrices, by azimuth order.
#pragma once
#include <memory>

#include "numeric/thread_pool.hpp"
#include "operators/directions.hpp"
#include "rough/facet_rays.hpp"
#include "rough/lobe_columns.hpp"

namespace lamina {

/// The glossy lobes of a boundary for light from one of its sides, as matrices by azimuth order.
///
/// Lobes may be narrower than the spacing of the nodes. They are therefore projected onto the polynomials through the
/// nodes (Galerkin). The projection is exact where the other factor of a product is smooth, and it conserves fluxes.
/// The outgoing side is projected by a sum over the rays from the facets, the incoming side by a sum over finer nodes
/// of the same ranges.
class LobeOperator {
 public:
  /// For light from the medium of index `ior` to the medium of index `beyond`; `beyond` = 0 for an opaque boundary.
  LobeOperator(FacetRays rays, DirectionSet set, double ior, double beyond, int orders)
      : rays_(std::move(rays)), set_(std::move(set)), ior_(ior), beyond_(beyond), orders_(orders) {}

  /// The columns for the targets of the medium of `ior`.
  std::shared_ptr<const LobeColumns> from_targets(const Directions& directions, ThreadPool& pool) const;

  /// The columns for the nodes of the set: [live node, live node].
  LobeColumns on_nodes(ThreadPool& pool) const;

 private:
  LobeColumns columns_from(const Eigen::VectorXd& mu, const Eigen::VectorXd& common, ThreadPool& pool) const;

  FacetRays rays_;
  DirectionSet set_;
  double ior_;
  double beyond_;
  int orders_;
  std::shared_ptr<LastColumns> last_ = std::make_shared<LastColumns>();
};

}  // namespace lamina
