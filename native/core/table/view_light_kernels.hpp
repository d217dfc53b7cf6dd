// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels of a stack of media between views and lights only.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "operators/scattering_function.hpp"
#include "solve/solution.hpp"

namespace lamina {

/// The independent blocks of a symmetric kernel on directions with views and lights: from all directions to the nodes,
/// and from lights to views. The other blocks are transposes of these.
struct KernelBlocks {
  Eigen::MatrixXd nodes;  ///< node, direction
  Eigen::MatrixXd pairs;  ///< view, light

  /// Writes the blocks to the kernel of an operator.
  void write(DirectionOperator& target) const;
};

/// The parts of ViewLightOrder that do not depend on the azimuth order. The solution must hold only media (see
/// has_only_media).
class ViewLightGeometry {
 public:
  ViewLightGeometry(const Solution& solution, const Eigen::VectorXd& views, const Eigen::VectorXd& lights);

  const Directions& directions() const { return directions_; }

  /// A medium of the stack. Its singly scattered light crosses the layers above or below on the way in and out.
  struct Medium {
    KernelBlocks turned;    ///< angular shape of single reflection, scaled
    KernelBlocks passed;    ///< that of single transmission
    Eigen::VectorXd above;  ///< transmittance of all layers above, by direction
    Eigen::VectorXd below;  ///< transmittance of all layers below; 0 over an opaque base
  };
  const std::vector<Medium>& media() const { return media_; }

 private:
  Directions directions_;
  std::vector<Medium> media_;
};

/// One azimuth order of a stack between views and lights.
struct ViewLightOrder {
  ScatteringFunction whole;
  /// Without single scattering by media and without delta parts, [view, light]. `above`: light enters and leaves above;
  /// `below`: enters and leaves below; `upward`: enters below and leaves above; `downward`: enters above, leaves below.
  Eigen::MatrixXd above;
  Eigen::MatrixXd below;
  Eigen::MatrixXd upward;
  Eigen::MatrixXd downward;

  ViewLightOrder(const Solution& solution, const ViewLightGeometry& geometry, int order);
};

}  // namespace lamina
