// SPDX-License-Identifier: GPL-3.0-or-later
// Restores the normalisation of a phase function on nodes that do not integrate it exactly.
#pragma once
#include <Eigen/Core>

namespace lamina {

/// A correction of a phase kernel on nodes that makes it conserve energy. Nodes shared by several media integrate the
/// phase function with a small error. The residual of the normalisation, r = 1 - p w, is returned as the smooth
/// symmetric kernel r_i + r_j - r.w. `scattered`: the kernel in symmetric scaling; `root`: square roots of the nodes'
/// weights.
Eigen::MatrixXd normalising_share(const Eigen::MatrixXd& scattered, const Eigen::VectorXd& root);

}  // namespace lamina
