// SPDX-License-Identifier: GPL-3.0-or-later
// A wide lobe as matrices by azimuth order, from its values between nodes.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "matter/microfacet.hpp"
#include "numeric/thread_pool.hpp"
#include "operators/directions.hpp"

namespace lamina {

/// A reflected lobe between one cosine and many directions, in 1/sr; symmetric. See RoughSurface::values.
using LobeValues = std::function<Eigen::ArrayXXd(double mu, const FacetPairs& pairs)>;

/// Matrices of the lobe of facets of width `alpha`, [live node, live node], by azimuth order, from its values at the
/// nodes of the medium of index `ior`. Where the nodes resolve a lobe, its values converge as fast as polynomials, and
/// high orders fall off as they must. Sums over rays leave noise there. Returns no matrices if the error of their
/// interpolation between the nodes exceeds `tolerance`, relative to the mean over azimuths.
std::vector<Eigen::MatrixXd> resolved_lobe(const LobeValues& lobe, const DirectionSet& set, double ior, int orders,
                                           double alpha, double tolerance, ThreadPool& pool);

}  // namespace lamina
