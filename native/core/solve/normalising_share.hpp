// SPDX-License-Identifier: GPL-3.0-or-later
// Restores the normalisation of a phase function on nodes that do not integrate it exactly.
#pragma once
#include <Eigen/Core>

namespace lamina {

/// What a phase kernel on nodes lacks of conserving energy. Nodes shared by several media integrate the phase function
/// not quite exactly. The residual of the normalisation, r = 1 - p w, is returned as the smooth symmetric kernel
/// r_i + r_j - r.w. `scattered`: the kernel in symmetric scaling; `root`: square roots of the nodes' weights.
Eigen::MatrixXd normalising_share(const Eigen::MatrixXd& scattered, const Eigen::VectorXd& root);

}  // namespace lamina
