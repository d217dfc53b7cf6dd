// SPDX-License-Identifier: GPL-3.0-or-later
// The discrete-ordinate modes of a homogeneous layer, one azimuth order.
#pragma once
#include <Eigen/Core>

#include <memory>

#include "matter/medium.hpp"
#include "operators/directions.hpp"
#include "operators/scattering_function.hpp"
#include "solve/flake_kernel.hpp"
#include "solve/phase_kernel.hpp"

namespace lamina {

/// The modes of the equation of transfer in a homogeneous medium, one azimuth order. They do not depend on the
/// thickness; a layer of any thickness, also infinite, follows without doubling.
///
/// With u = I+ + I- and v = I+ - I- (down- and upwelling radiance, symmetric scaling) the discretised
/// equation of transfer is du/dt = -A v, dv/dt = -B u, A and B symmetric and positive (semi)definite
/// (Nakajima and Tanaka 1986). With A = L L' and L' B L = Z k^2 Z' the fields are combinations of
/// U = L Z and V = L'^-1 Z times cosh(kt) and sinh(kt). For light that enters both faces with equal or opposite signs,
///   R + T = (1 - G) (1 + G)^-1,  G = V k tanh(k tau/2) V',
///   R - T = -(1 - H) (1 + H)^-1, H = U tanh(k tau/2)/k U',
/// without growing exponentials or special cases.
class HomogeneousModes {
 public:
  /// `phase`, between the live nodes, is needed for flakes only: other media have moments.
  HomogeneousModes(const TruncatedMedium& medium, int order, const Directions& directions,
                   const PhaseKernel* phase = nullptr);

  struct Layer {
    Eigen::MatrixXd reflect;   ///< R = R', symmetric scaling
    Eigen::MatrixXd transmit;  ///< T with its direct part on the diagonal
  };
  Layer layer(double tau) const;

 private:
  Eigen::MatrixXd even_;  // U
  Eigen::MatrixXd odd_;   // V
  Eigen::VectorXd rate_;  // k
};

/// The kernels pi f of multiple scattering (all orders but the first), divided by the angular shape of single
/// scattering and by the sines that make odd azimuth orders vanish at normal incidence. They are smooth in both cosines
/// for any thickness, so polynomials through the nodes interpolate them.
struct MultipleScattering {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;
  Eigen::VectorXd survival;  ///< order 0: share of the light removed from a beam that leaves the layer
};

MultipleScattering multiple_scattering(HomogeneousModes::Layer layer, const TruncatedMedium& medium,
                                       const PhaseKernel& phase, int order, const Directions& directions);

/// Angular shapes of a layer's single scattering between all directions of its medium, the same for all azimuth orders.
struct LayerShapes {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;
  std::shared_ptr<const FlakeKernel> flakes;  ///< null for other media

  LayerShapes(const Directions& directions, const TruncatedMedium& medium);
};

/// Scaled kernels of a layer between the live nodes and targets of its medium, before Directions::spread.
struct LayerKernels {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;
};

/// The parts of a layer's scattering function on any directions: multiple scattering by interpolation, single
/// scattering in closed form, and the direct part.
LayerKernels multiple_on(const Directions& directions, const MultipleScattering& multiple,
                         const TruncatedMedium& medium, const LayerShapes& shapes, int order);
/// Factors by target that restore the energy balance of multiple_on between targets and nodes in order 0, where sums of
/// interpolated kernels are off by about 1e-6. They follow from `survival`, which is exact at the nodes, smooth, and 1
/// without absorption. `once` and `repeated` are the kernels of single and multiple scattering, [node, target],
/// reflection plus transmission.
Eigen::VectorXd energy_factors(const Directions& directions, const MultipleScattering& multiple,
                               const TruncatedMedium& medium, const Eigen::MatrixXd& once,
                               const Eigen::MatrixXd& repeated);
/// Of flakes, without the part between two targets, which is always in closed form.
LayerKernels single_on(const Directions& directions, const TruncatedMedium& medium, const LayerShapes& shapes,
                       int order);
Eigen::VectorXd direct_transmissions(const Eigen::VectorXd& mu, double tau);
Eigen::VectorXd direct_transmissions(const Eigen::VectorXd& mu, const TruncatedMedium& medium);

/// The sum of the three parts, where `once` is the single scattering.
ScatteringFunction layer_on(const Directions& directions, const MultipleScattering& multiple,
                            const TruncatedMedium& medium, const LayerShapes& shapes, const LayerKernels& once,
                            int order);

}  // namespace lamina
