// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "directions.hpp"
#include "medium.hpp"
#include "scattering_function.hpp"

namespace lamina {

/// The modes of the equation of transfer in a homogeneous medium, one azimuth order: everything about a
/// layer but its thickness. A layer of any thickness, also infinite, follows without doubling.
///
/// With u = I+ + I- and v = I+ - I- (down- and upwelling radiance, symmetric scaling) the discretised
/// equation of transfer is du/dt = -A v, dv/dt = -B u, A and B symmetric and positive (semi)definite
/// (Nakajima and Tanaka 1986). With A = L L' and L' B L = Z k^2 Z' the fields are combinations of
/// U = L Z and V = L'^-1 Z times cosh(kt) and sinh(kt); light that enters both faces alike or oppositely
/// then sees
///   R + T = (1 - G) (1 + G)^-1,  G = V k tanh(k tau/2) V',
///   R - T = -(1 - H) (1 + H)^-1, H = U tanh(k tau/2)/k U',
/// which has no growing exponential and no special case.
class HomogeneousModes {
 public:
  HomogeneousModes(const TruncatedMedium& medium, int order, const Directions& directions);

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

/// Nodes that serve several media integrate the phase function's moments almost, but not quite exactly;
/// what is missing from the normalisation, r = 1 - p w, is added as the smooth symmetric r_i + r_j - r.w.
Eigen::MatrixXd normalising_share(const Eigen::MatrixXd& scattered, const Eigen::VectorXd& root);

/// What single scattering leaves of a layer: the kernels pi f of all higher orders, divided by the angular
/// shape of single scattering (and by the sines that make odd azimuth orders vanish at normal incidence).
/// Smooth in both cosines however thin the layer, so that polynomials through the nodes hold it anywhere.
struct MultipleScattering {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;
  Eigen::VectorXd survival;  ///< order 0: share of the light taken out of a beam that leaves the layer again
};

/// The moments of the phase function in one azimuth order between directions: sum over l of
/// (2l+1) chi_l P_l^m P_l^m, with light turned back (reflect) or passing on (transmit).
struct PhaseKernel {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;

  PhaseKernel(const TruncatedMedium& medium, int order, const Eigen::VectorXd& mu);
};

MultipleScattering multiple_scattering(HomogeneousModes::Layer layer, const TruncatedMedium& medium,
                                       const PhaseKernel& phase, int order, const Directions& directions);

/// Angular shapes of a layer's single scattering between all directions of its medium, of no azimuth order.
struct LayerShapes {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;

  LayerShapes(const Directions& directions, double tau);
};

/// Kernels of a layer between the live nodes and targets of its medium, scaled; not yet spread.
struct LayerKernels {
  Eigen::MatrixXd reflect;
  Eigen::MatrixXd transmit;
};

/// The parts of a layer's scattering function on any directions: multiple scattering, carried there by
/// interpolation; single scattering, in closed form; the direct part.
LayerKernels multiple_on(const Directions& directions, const MultipleScattering& multiple,
                         const TruncatedMedium& medium, const LayerShapes& shapes, int order);
/// Sums over nodes of interpolated kernels miss the energy balance by some 1e-6 at targets. The share of the removed
/// light that survives is known at the nodes, smooth, and 1 where nothing is absorbed: factors that restore it, by
/// target, for what multiple_on says between targets and nodes in order 0. Of `once` and `repeated`, the kernels of
/// single and multiple scattering, [node, target], reflection and transmission summed.
Eigen::VectorXd energy_factors(const Directions& directions, const MultipleScattering& multiple,
                               const TruncatedMedium& medium, const Eigen::MatrixXd& once,
                               const Eigen::MatrixXd& repeated);
LayerKernels single_on(const Directions& directions, const TruncatedMedium& medium, const LayerShapes& shapes,
                       int order);
Eigen::VectorXd direct_transmissions(const Eigen::VectorXd& mu, double tau);

/// All three together, of which `once` is known.
ScatteringFunction layer_on(const Directions& directions, const MultipleScattering& multiple,
                            const TruncatedMedium& medium, const LayerShapes& shapes, const LayerKernels& once,
                            int order);

}  // namespace lamina
