// SPDX-License-Identifier: GPL-3.0-or-later
// Associated Legendre functions of one azimuth order.
#pragma once
#include <Eigen/Core>

namespace lamina {

/// Associated Legendre functions of one azimuth order m, normalised to sqrt((l-m)!/(l+m)!) P_l^m, so that
/// the addition theorem reads P_l(cos) = sum_m (2 - delta_m0) P_l^m(mu) P_l^m(mu') cos(m dphi).
/// Row k holds degree l = m + k, one column per cosine; no rows when count <= m.
Eigen::MatrixXd associated_legendre(int order, int count, const Eigen::VectorXd& mu);

}  // namespace lamina
