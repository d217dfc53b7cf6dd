// SPDX-License-Identifier: GPL-3.0-or-later
// Directions outside a stack with anisotropic facets: their specular paths, and the light that layers first scatter.
#pragma once
#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

#include "numeric/thread_pool.hpp"
#include "operators/delta_field.hpp"
#include "oriented/medium_orders.hpp"
#include "oriented/oriented_solution.hpp"

namespace lamina {

/// A direction of travel outside the stack, from above or from below; as a view the direction where light leaves.
struct Beam {
  double mu = 1.0;   ///< in air
  double phi = 0.0;  ///< in the frame of the stack
  bool below = false;

  auto operator<=>(const Beam&) const = default;
};

/// The specular light of the whole stack for cosines in air.
Deltas specular_light(const OrientedSolution& solution, const Eigen::VectorXd& mu);

/// Some directions outside a stack. Rough surfaces and media scatter the light of each for the first time, where its
/// specular path meets them; by reciprocity the same numbers hold for light that is scattered into it for the last
/// time.
class BeamSet {
 public:
  BeamSet(const OrientedSolution& solution, std::vector<Beam> beams, ThreadPool& pool);

  /// The light of the beams after its first scattering, a column for each beam.
  const GapLight& scattered() const { return scattered_; }
  /// Light that one layer scatters from a beam into another, in 1/sr: once by facets, or any number of times by a
  /// medium.
  double by_one_layer(std::size_t out, std::size_t in) const;

 private:
  struct Arrival {
    double down;  ///< share at the top of the layer
    double up;    ///< share at its bottom
  };
  Arrival arrival(std::size_t beam, std::size_t layer) const;
  Heading heading(std::size_t beam, std::size_t gap) const;
  void add_surface(std::size_t layer, std::size_t beam);
  void add_medium(std::size_t layer, const MediumOnTargets& medium, std::size_t beam);
  void add(std::size_t gap, bool up, std::size_t beam, const Eigen::MatrixXd& values);
  double by_facets(std::size_t layer, std::size_t out, std::size_t in) const;
  double by_medium(std::size_t scatterer, std::size_t out, std::size_t in) const;

  const OrientedSolution& solution_;
  std::vector<Beam> beams_;
  std::vector<Eigen::Index> target_;  // by beam
  std::vector<Directions> gaps_;
  DeltaField deltas_;
  std::vector<MediumOnTargets> media_;
  std::vector<std::vector<std::array<double, 2>>> lost_;  // [layer][beam], at its top and at its bottom
  GapLight scattered_;
};

}  // namespace lamina
