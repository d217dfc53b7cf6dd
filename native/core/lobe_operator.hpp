// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "directions.hpp"
#include "microfacet.hpp"
#include "thread_pool.hpp"

namespace lamina {

/// The glossy lobe of a boundary, from directions in one medium to directions in another or the same, as
/// matrices by azimuth order.
///
/// Lobes may be narrower than the spacing of the nodes. They are therefore sampled on finer nodes of the
/// same ranges and projected onto the polynomials that the nodes carry (Galerkin): exact wherever one side
/// of a product is smooth, symmetric, and keeping every flux. Entries between two targets stay zero: there
/// the lobe is wanted exactly, and known in closed form.
class LobeOperator {
 public:
  /// Values at all azimuths for a cosine on the outgoing and one on the incoming side; `factor` in the
  /// scaling of Directions: pi for a BRDF.
  using Lobe = std::function<Eigen::ArrayXd(double mu_out, double mu_in, const Eigen::ArrayXd& cosines)>;

  LobeOperator(Lobe lobe, const AzimuthTransform& azimuth, const DirectionSet& set, const DirectionSet& fine,
               double ior_out, double ior_in, ThreadPool& pool);

  /// All orders on directions with targets.
  std::vector<Eigen::MatrixXd> on(const Directions& out, const Directions& in, ThreadPool& pool) const;

 private:
  std::vector<Eigen::MatrixXd> between(const Eigen::VectorXd& mu_out, const Eigen::VectorXd& scale_out,
                                       const Eigen::VectorXd& mu_in, const Eigen::VectorXd& scale_in,
                                       ThreadPool& pool) const;

  Lobe lobe_;
  AzimuthTransform azimuth_;
  Directions fine_out_;
  Directions fine_in_;
  Eigen::MatrixXd carry_out_;  // fine live nodes by live nodes
  Eigen::MatrixXd carry_in_;
  std::vector<Eigen::MatrixXd> nodes_;  // by order, live nodes
};

}  // namespace lamina
