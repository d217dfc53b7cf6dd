// SPDX-License-Identifier: GPL-3.0-or-later
// A stack as the elements between which walks move, and the quantity that a walk estimates.
#pragma once
#include <memory>
#include <vector>

#include "matter/stack.hpp"
#include "solve/evaluation.hpp"
#include "walks/facet_scatter.hpp"
#include "walks/sphere.hpp"

namespace lamina {

/// What a walk through a stack estimates: BRDF or BTDF (1/sr, as evaluate_points gives them: without mirror and
/// unscattered light) for a pair of cosines in air and an azimuth; or with `flux` the hemispherical reflectance or
/// transmittance of a beam at mu_i, with them.
struct WalkTarget {
  Side side = Side::kTop;
  Path path = Path::kReflect;
  double mu_o = 1.0;
  double mu_i = 1.0;
  double dphi = 0.0;
  bool flux = false;
};

/// A stack as walks go through it: turned so that light enters at the top, the base as its last element.
struct WalkElements {
  struct Element {
    enum class Kind { kMedium, kSmooth, kRough, kLambert, kMetal };
    Kind kind = Kind::kMedium;
    Medium medium = {};                          ///< kMedium; of a graded one the largest albedo
    std::shared_ptr<const GradedMedium> graded;  ///< kMedium, where it varies with depth
    double reflectance = 0.0;                    ///< kLambert
    std::complex<double> metal = {};             ///< kMetal, polished: relative index
    std::shared_ptr<const FacetScatter> facets;  ///< kRough
  };
  std::vector<Element> elements;
  std::vector<double> ior;  ///< of the gap above each element, and below the last

  /// With `ended` a conservative medium without end becomes one so thick that its end is not seen, on a surface
  /// that returns everything: walks in it end. Throws std::invalid_argument for light from below onto a base.
  WalkElements(const Stack& stack, Side side, bool ended = true);
};

/// A beam from outside and all that becomes of it without being scattered; the way back out by reciprocity.
class WalkBeam {
 public:
  /// At an element: the direction of travel that arrives at its top and at its bottom, with what share of the power.
  struct Arrival {
    Ray down;
    Ray up;
    double at_top = 0.0;
    double at_bottom = 0.0;
  };
  std::vector<Arrival> at;
  double reflected = 0.0;    ///< the mirror image
  double transmitted = 0.0;  ///< the unscattered beam

  /// Of cosine `mu` in air, travelling along azimuth `phi`, from above or from below the stack.
  WalkBeam(const WalkElements& stack, double mu, double phi, bool from_below);
  /// One that begins at an element, the first or the last, and runs from there into the stack.
  WalkBeam(const WalkElements& stack, std::size_t from, const Ray& within);

 private:
  /// Through elements [first, last); `sine` is that in air, above 1 where air has no such ray.
  void pass(const WalkElements& stack, std::size_t first, std::size_t last, double sine, const Ray& heading,
            bool from_below);
};

}  // namespace lamina
