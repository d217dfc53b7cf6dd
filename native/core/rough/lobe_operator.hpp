// SPDX-License-Identifier: GPL-3.0-or-later
// The glossy lobes of a rough boundary as matrices, by azimuth order.
#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "numeric/thread_pool.hpp"
#include "operators/directions.hpp"
#include "rough/facet_rays.hpp"

namespace lamina {

/// The glossy lobes of a boundary for light from one of its sides, as matrices by azimuth order.
///
/// Lobes may be narrower than the spacing of the nodes. They are therefore projected onto the polynomials
/// that the nodes carry (Galerkin): exact wherever one side of a product is smooth, and keeping every flux.
/// The projection on the outgoing side is a sum over the rays that the facets send, that on the incoming
/// side one over finer nodes of the same ranges, along which the sum is smooth.
class LobeOperator {
 public:
  /// What leaves into the nodes' polynomials on the light's own side and on the other, by order: live nodes of
  /// that medium by incoming directions.
  struct Columns {
    std::vector<Eigen::MatrixXd> reflected;
    std::vector<Eigen::MatrixXd> transmitted;
  };

  /// From the medium of index `ior` to that of index `beyond`; 0: nothing passes.
  LobeOperator(FacetRays rays, DirectionSet set, double ior, double beyond, int orders)
      : rays_(std::move(rays)), set_(std::move(set)), ior_(ior), beyond_(beyond), orders_(orders) {}

  /// Light that comes along directions of the medium of `ior`; `common` is C of each, see Directions.
  /// The last answer is kept: the rows of a lookup table ask for the same directions again and again.
  std::shared_ptr<const Columns> from(const Eigen::VectorXd& mu, const Eigen::VectorXd& common, ThreadPool& pool) const;

  /// The same on the nodes' polynomials: live nodes by live nodes.
  Columns on_nodes(ThreadPool& pool) const;

 private:
  struct Answer {
    std::mutex lock;
    Eigen::VectorXd mu;
    Eigen::VectorXd common;
    std::shared_ptr<const Columns> columns;
  };

  Columns columns_from(const Eigen::VectorXd& mu, const Eigen::VectorXd& common, ThreadPool& pool) const;

  FacetRays rays_;
  DirectionSet set_;
  double ior_;
  double beyond_;
  int orders_;
  std::shared_ptr<Answer> last_ = std::make_shared<Answer>();
};

}  // namespace lamina
