// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels of a stack of media between views and lights, without the rest of the matrices.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "operators/scattering_function.hpp"
#include "solve/solution.hpp"

namespace lamina {

/// The independent blocks of a symmetric kernel on directions with views and lights: from all directions to
/// the nodes, and from lights to views. Everything else that is wanted is their transpose.
struct KernelBlocks {
  Eigen::MatrixXd nodes;  ///< node, direction
  Eigen::MatrixXd pairs;  ///< view, light

  /// The same as the kernel of an operator.
  void write(DirectionOperator& target) const;
};

/// What the media of a solution, which must hold only media (see has_only_media), look like between views and lights,
/// apart from the azimuth order.
class ViewLightGeometry {
 public:
  ViewLightGeometry(const Solution& solution, const Eigen::VectorXd& views, const Eigen::VectorXd& lights);

  const Directions& directions() const { return directions_; }

  /// A medium of the stack. Light that it scatters once crosses the layers above or below it on its way in
  /// and out.
  struct Medium {
    KernelBlocks turned;    ///< angular shape of single reflection, scaled
    KernelBlocks passed;    ///< that of single transmission
    Eigen::VectorXd above;  ///< share of light that comes through all above, by direction
    Eigen::VectorXd below;  ///< through all below; 0 over an opaque base
  };
  const std::vector<Medium>& media() const { return media_; }

 private:
  Directions directions_;
  std::vector<Medium> media_;
};

/// One azimuth order of a stack between views and lights.
struct ViewLightOrder {
  ScatteringFunction whole;
  /// Without light scattered once by a medium, and without delta parts: [view, light], light that enters and
  /// leaves above; enters and leaves below; enters below and leaves above; enters above and leaves below.
  Eigen::MatrixXd above;
  Eigen::MatrixXd below;
  Eigen::MatrixXd upward;
  Eigen::MatrixXd downward;

  ViewLightOrder(const Solution& solution, const ViewLightGeometry& geometry, int order);
};

}  // namespace lamina
