// SPDX-License-Identifier: GPL-3.0-or-later
// A stack as the elements of a walk, and the quantity that a walk estimates.
#pragma once
#include <memory>
#include <vector>

#include "events/scattering_surface.hpp"
#include "events/sphere.hpp"
#include "matter/stack.hpp"
#include "solve/evaluation.hpp"

namespace lamina {

/// The quantity that a walk estimates: BRDF or BTDF (1/sr, as evaluate_points, without specular and unscattered light)
/// for a pair of cosines in air and an azimuth; or with `flux` the hemispherical reflectance or transmittance of a beam
/// at mu_i, with specular and unscattered light. `phi`: the azimuth, from the x axis of the stack, of the outgoing
/// light, with `flux` of the beam. Walks turn the stack, so that light comes in along the x axis.
struct WalkTarget {
  Side side = Side::kTop;
  Path path = Path::kReflect;
  double mu_o = 1.0;
  double mu_i = 1.0;
  double dphi = 0.0;
  bool flux = false;
  double phi = 0.0;

  /// The angle by which walks turn the stack.
  double turn() const { return flux ? -phi : dphi - phi; }
};

/// A stack as a list of elements, turned so that light enters at the top; the base is the last element.
struct WalkElements {
  struct Element {
    enum class Kind { kMedium, kSmooth, kRough, kLambert, kMirror };
    Kind kind = Kind::kMedium;
    Medium medium = {};                               ///< kMedium; with the largest albedo if it is graded
    std::shared_ptr<const GradedMedium> graded;       ///< kMedium that varies with depth
    double reflectance = 0.0;                         ///< kLambert
    Base mirror = {};                                 ///< kMirror
    std::shared_ptr<const ScatteringSurface> facets;  ///< kRough
    FacetOptics from_above = {};                      ///< kSmooth
    FacetOptics from_below = {};                      ///< kSmooth

    /// True if light keeps to specular paths at this element.
    bool is_polished() const { return kind == Kind::kSmooth || kind == Kind::kMirror; }
    /// True for a surface that scatters light.
    bool is_scattering_surface() const { return kind == Kind::kRough || (kind == Kind::kLambert && reflectance > 0.0); }
  };
  std::vector<Element> elements;
  std::vector<double> ior;  ///< above each element, and below the last

  /// The stack as walks to `target` meet it: from its side, and turned. With `ended` an infinite conservative medium is
  /// replaced by a very thick one on a perfect reflector, so that walks end. Throws std::invalid_argument for light
  /// from below onto a base.
  WalkElements(const Stack& stack, const WalkTarget& target, bool ended = true);
};

/// The specular light of a beam from outside; by reciprocity also the specular path from each element to the outside.
class WalkBeam {
 public:
  /// At an element: the directions of travel at its top and at its bottom, and their shares of the power.
  struct Arrival {
    Ray down;
    Ray up;
    double at_top = 0.0;
    double at_bottom = 0.0;
  };
  std::vector<Arrival> at;
  double reflected = 0.0;    ///< power that leaves specularly on the side of incidence
  double transmitted = 0.0;  ///< power that leaves specularly on the other side

  /// A beam with cosine `mu` in air, travelling along azimuth `phi`, from above or from below the stack.
  WalkBeam(const WalkElements& stack, double mu, double phi, bool from_below);
  /// A beam that starts at the first or the last element and travels into the stack.
  WalkBeam(const WalkElements& stack, std::size_t from, const Ray& within);

 private:
  /// Traces the beam through elements [first, last); `sine` is the sine in air, above 1 if air has no such ray.
  void pass(const WalkElements& stack, std::size_t first, std::size_t last, double sine, const Ray& heading,
            bool from_below);
};

}  // namespace lamina
