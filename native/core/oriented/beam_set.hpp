// SPDX-License-Identifier: GPL-3.0-or-later
// Directions outside a stack with anisotropic facets: their specular paths, and the light that layers first scatter.
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "numeric/thread_pool.hpp"
#include "oriented/medium_orders.hpp"
#include "oriented/specular_paths.hpp"

namespace lamina {

/// A direction of travel outside the stack, from above or from below; as a view the direction where light leaves.
struct Beam {
  double mu = 1.0;   ///< in air
  double phi = 0.0;  ///< in the frame of the stack
  bool below = false;

  auto operator<=>(const Beam&) const = default;
};

/// Some directions outside a stack. Rough surfaces and media scatter the light of each for the first time, where its
/// specular path meets them; by reciprocity the same numbers hold for light that is scattered into it for the last
/// time.
class BeamSet {
 public:
  BeamSet(const OrientedSolution& solution, const std::vector<Beam>& beams, ThreadPool& pool);
  /// The same beams for the stack of `bare` with another thickness of the medium on top, whose thickness was 0.
  BeamSet(const OrientedSolution& solution, const BeamSet& bare, ThreadPool& pool);

  /// The light of the beams after its first scattering, a column for each beam; none where no layer scatters light.
  const GapLight& scattered() const { return scattered_; }
  /// Light that one layer scatters from a beam into another, in 1/sr: once by facets, or any number of times by a
  /// medium.
  double by_one_layer(std::size_t out, std::size_t in) const;
  /// Of by_one_layer: light without a direction, what media scatter between the cosines of two beams whose azimuths
  /// differ by `dphi`, and the rest, which facets scatter once.
  double evenly(std::size_t out, std::size_t in) const;
  double by_media(std::size_t out, std::size_t in, double dphi) const;

 private:
  void open(std::size_t layer);
  void add_surface(std::size_t layer, std::size_t beam);
  void add_medium(std::size_t layer, const MediumOnTargets& medium, std::size_t beam);
  void add(std::size_t gap, bool up, std::size_t beam, const Eigen::MatrixXd& values);
  double by_medium(std::size_t scatterer, std::size_t out, std::size_t in, double dphi) const;

  const OrientedSolution& solution_;
  Eigen::VectorXd cosines_;
  SpecularPaths paths_;
  std::vector<SpecularPaths::Arrived> beams_;
  std::vector<MediumOnTargets> media_;
  std::vector<std::vector<std::array<double, 2>>> lost_;  // [layer][beam], at its top and at its bottom
  GapLight scattered_;
};

}  // namespace lamina
