// SPDX-License-Identifier: GPL-3.0-or-later
// A stack with lengths, solved at a lateral frequency by adding.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "lateral/lateral_layer.hpp"
#include "matter/stack.hpp"
#include "numeric/thread_pool.hpp"
#include "rough/rough_surface.hpp"

namespace lamina {

/// One channel of a stack of homogeneous layers, with lengths in millimetres by layer.
struct MeasuredStack {
  Stack stack;
  std::vector<double> extinction;  ///< by layer, of media: 1/mm
  std::vector<double> thickness;   ///< by layer, of media: mm; infinite for a half-space
  std::vector<double> whole_tau;   ///< by layer, of media: optical thickness of the graded medium with this slice
};

/// The cosine in air above which directions may be denser.
inline constexpr double kForward = 0.9;

/// The discretisation of directions at lateral frequencies.
struct LateralResolution {
  int nodes = 12;              ///< number of nodes for cosines from 0 to 1
  Eigen::Index azimuths = 12;  ///< largest number of azimuths at any frequency
  double bend = 0.2;           ///< bend of the azimuths' path, see AzimuthRule
  int forward = 0;             ///< number of further nodes for cosines in air above kForward; 0: no such range
  int moments() const { return forward > 0 ? 4 * forward : 2 * nodes; }
};

/// The flux that leaves a stack for a beam from above, at one lateral frequency.
struct LateralFlux {
  double reflected = 0.0;
  double transmitted = 0.0;
  double mirrored = 0.0;     ///< part of the reflected flux that was only reflected specularly
  double unscattered = 0.0;  ///< part of the transmitted flux; truncated peaks count as unscattered
};

/// A stack on given directions, to be evaluated at any lateral frequency.
class LateralStack {
 public:
  /// `mu`: cosine of the beam in air. Throws std::runtime_error if a rough boundary cannot be resolved.
  LateralStack(const MeasuredStack& measured, const LateralResolution& resolution, double mu, ThreadPool& pool);

  /// Media transmit unscattered light by finer directions from now on, see LateralMedium::resolve_passing.
  void resolve_passing();

  /// Fluxes at the lateral frequency q, 1/mm. Thread-safe.
  LateralFlux at(double q, const AzimuthRule& azimuths) const;
  /// The limit of high frequencies: light that leaves at the point of entry.
  LateralFlux at_infinity() const;

  const MeasuredStack& measured() const { return measured_; }
  const LateralResolution& resolution() const { return resolution_; }
  double mu() const { return mu_; }
  bool along_normal() const { return mu_ == 1.0; }
  /// Directions above each layer and below the last, with their refractive indices; the beam is their target.
  const std::vector<Directions>& directions() const { return directions_; }
  /// Media by layer; empty for boundaries and for media without thickness.
  const std::vector<std::optional<LateralMedium>>& media() const { return media_; }
  /// A rough boundary by azimuth orders, over nodes and the target.
  struct Lobes {
    std::vector<Eigen::MatrixXd> reflect_above;
    std::vector<Eigen::MatrixXd> down;
    std::vector<Eigen::MatrixXd> reflect_below;
    std::vector<Eigen::MatrixXd> up;
  };
  /// A rough boundary or, one past the layers, a rough base.
  struct Rough {
    std::unique_ptr<RoughSurface> surface;
    Lobes lobes;
    /// The light of the beam, reflected and transmitted: flux along live nodes, and the part of it that facets scatter
    /// repeatedly.
    std::array<Eigen::VectorXd, 2> spread;
    std::array<Eigen::VectorXd, 2> repeated;
    /// The share of light along each live node, above and below, that passes the boundary.
    std::array<Eigen::VectorXd, 2> passed;
  };
  const Rough* rough(std::size_t layer) const { return rough_[layer].get(); }

 private:
  void add_rough(std::unique_ptr<RoughSurface> surface, std::size_t layer, ThreadPool& pool);
  LateralFunction boundary(std::size_t layer, const LateralRows& rows) const;
  Eigen::MatrixXd base(const LateralRows& rows) const;
  template <typename LayerOf>
  LateralFlux joined(const LateralRows& rows, const LayerOf& layer_of) const;

  MeasuredStack measured_;
  LateralResolution resolution_;
  double mu_;
  std::optional<DirectionSet> set_;
  std::vector<Directions> directions_;
  std::vector<std::optional<LateralMedium>> media_;
  std::vector<std::unique_ptr<Rough>> rough_;  // by layer, the base last
};

}  // namespace lamina
