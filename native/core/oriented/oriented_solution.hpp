// SPDX-License-Identifier: GPL-3.0-or-later
// A stack with anisotropic facets, solved on nodes and functions of the azimuth.
#pragma once
#include <memory>
#include <vector>

#include "oriented/block_operator.hpp"
#include "oriented/oriented_surface.hpp"
#include "solve/solution.hpp"

namespace lamina {

/// The discretisation of a stack with anisotropic facets.
struct OrientedResolution {
  int nodes = 24;
  int orders = 32;    ///< of azimuth functions
  int fineness = 64;  ///< see FacetBundle
};

/// The resolution for a relative error `tolerance`. Throws std::runtime_error for facets that are too narrow.
OrientedResolution choose_oriented_resolution(const Stack& stack, double tolerance);

/// Radiance in each gap between layers, by block of azimuth functions: columns over functions and live nodes, one for
/// each problem. As sources: light that layers emit into the gaps.
struct GapLight {
  std::vector<std::vector<Eigen::MatrixXd>> up;    ///< [block][gap]
  std::vector<std::vector<Eigen::MatrixXd>> down;  ///< [block][gap]
};

/// One channel of a stack whose rough boundaries couple azimuths, with all orders of reflection between its layers.
///
/// Gap k lies above layer k, the last one above the base. The solver for isotropic stacks gives the media, without
/// rough boundaries; the facets are operators of their own. The light of a direction outside follows specular paths to
/// the layers that first scatter it into the nodes, and leaves likewise: see evaluate_oriented.
class OrientedSolution {
 public:
  /// Throws std::runtime_error if the stack cannot be resolved. The base must be reciprocal.
  OrientedSolution(const Stack& stack, double tolerance, const OrientedResolution& resolution, ThreadPool& pool);

  /// The stack with another thickness of the homogeneous medium on top of it; what lies below is not solved again.
  /// Throws std::invalid_argument if the top layer is none.
  OrientedSolution with_top_thickness(double tau, ThreadPool& pool) const;

  const Stack& stack() const { return stack_; }
  /// The media, between smooth boundaries.
  const Solution& media() const { return media_; }
  const AzimuthBlocks& azimuths() const { return azimuths_; }
  const SolveChecks& checks() const { return checks_; }
  /// The azimuth of the x axis of the solve from that of the stack.
  double frame() const { return frame_; }
  /// The rough boundary of a layer or, one past the layers, of the base; null if it is none.
  const OrientedSurface* surface(std::size_t layer) const { return surfaces_[layer].get(); }
  /// The directions in each gap, with targets in air.
  std::vector<Directions> directions(const Eigen::VectorXd& targets) const { return media_.directions(targets); }

  /// The radiance in all gaps that the sources cause.
  GapLight light(GapLight sources) const;
  /// Sources without light, for a number of problems.
  GapLight dark(Eigen::Index problems) const;

 private:
  OrientedSolution(SublayerStack sublayers, double tolerance, const OrientedResolution& resolution, ThreadPool& pool);
  void add_surfaces(int fineness, ThreadPool& pool);
  void add_layers(ThreadPool& pool);
  void join(std::size_t block);
  Eigen::MatrixXd reflected_between(std::size_t block, std::size_t layer, const Eigen::MatrixXd& below) const;
  bool has_medium_on_top() const;
  Eigen::Index size(std::size_t block, std::size_t gap) const;

  Stack stack_;
  Solution media_;
  double frame_;
  AzimuthBlocks azimuths_;
  std::vector<Directions> gaps_;
  std::vector<std::shared_ptr<const OrientedSurface>> surfaces_;  // by layer, then the base
  std::shared_ptr<OrientedSurface> base_surface_;                 // the last of them, of this solution alone
  std::vector<std::vector<BlockLayer>> layers_;                   // [block][layer]
  std::vector<BlockOperator> base_;                               // [block]; empty once it is joined
  /// [block][layer]: Q = B (1 - R' B)^-1 with the layer's R' and the reflection B of all that lies below it. Single
  /// precision halves most of the memory of a solution.
  std::vector<std::vector<Eigen::MatrixXf>> between_;
  std::vector<Eigen::MatrixXf> below_top_;  // [block]: the reflection B below a medium on top of the stack, if any
  SolveChecks checks_;
};

}  // namespace lamina
