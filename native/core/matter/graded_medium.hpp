// SPDX-License-Identifier: GPL-3.0-or-later
// A medium whose albedo and phase function vary with depth, linearly between knots.
#pragma once
#include <cstddef>
#include <vector>

#include "phase/phase.hpp"

namespace lamina {

/// Scattering at one depth: k(cosine) = first p(cosine) + second q(cosine), the albedo times the phase function (4 pi
/// times its density).
struct LocalScattering {
  double first = 0.0;
  double second = 0.0;
  const PhaseFunction* p = nullptr;
  const PhaseFunction* q = nullptr;

  double albedo() const { return first + second; }
  double evaluate(double cosine) const {
    const double value = first * p->evaluate(cosine);
    return second > 0.0 ? value + second * q->evaluate(cosine) : value;
  }
  /// evaluate() for many cosines, in single precision.
  template <typename Cosines>
  Cosines evaluate_all(const Cosines& cosine) const {
    const HenyeyGreenstein* lobe = second > 0.0 ? nullptr : p->as_henyey_greenstein();
    if (lobe == nullptr) {
      return cosine.unaryExpr([&](float c) { return static_cast<float>(evaluate(static_cast<double>(c))); });
    }
    const auto g = static_cast<float>(lobe->g);
    const Cosines denominator = 1.0F + g * g - (2.0F * g) * cosine;
    return (static_cast<float>(first) * (1.0F - g * g)) / (denominator * denominator.sqrt());
  }

  /// The cosine for a uniform u in (0, 1), with density evaluate(cosine) / (2 albedo).
  double sample(double u) const {
    const double share = second > 0.0 ? first / (first + second) : 1.0;
    return u < share ? p->sample(u / share) : q->sample((u - share) / (1.0 - share));
  }
};

/// A slab whose properties vary with depth. Between knots, albedo times phase function is linear in the optical depth.
/// Two knots at one depth are a jump.
class GradedMedium {
 public:
  struct Knot {
    double tau = 0.0;     ///< optical depth below the top
    double albedo = 0.0;  ///< [0, 1]
    PhaseFunction phase;
  };

  /// Knots from the top, tau 0, to the bottom. tau ascends, with equal neighbours only between the first and the last.
  /// Throws std::invalid_argument otherwise.
  explicit GradedMedium(std::vector<Knot> knots);
  /// Knots without pieces so thin that rounding may take their thickness away: these become jumps inside, and nothing
  /// at the ends.
  static std::vector<Knot> without_slivers(std::vector<Knot> knots);
  static GradedMedium homogeneous(double albedo, double tau, const PhaseFunction& phase);

  /// The slab on a Lambert surface of that reflectance, [0, 1], which is S at t = 0 for the scattering equation.
  /// Without this call the slab lies over nothing.
  GradedMedium over(double reflectance) const;
  double ground() const { return ground_; }
  /// The slab upside down, over nothing.
  GradedMedium turned() const;

  double tau() const { return knots_.back().tau; }
  bool is_homogeneous() const { return homogeneous_; }
  bool is_isotropic() const { return isotropic_; }
  const std::vector<Knot>& knots() const { return knots_; }
  /// Optical heights of the knots between top and bottom, ascending; the height of a jump occurs twice.
  std::vector<double> inner_heights() const;
  double largest_albedo() const;
  /// The phase function of the knot with the largest absolute mean cosine.
  const PhaseFunction& sharpest_phase() const;
  /// True if both ends of the piece below knot `above` have the same phase function.
  bool keeps_phase(std::size_t above) const { return keeps_phase_[above]; }
  bool is_constant(std::size_t above) const {
    return keeps_phase_[above] && knots_[above].albedo == knots_[above + 1].albedo;
  }

  /// The scattering at the optical height t above the bottom; at a jump, the one below it.
  LocalScattering at(double t) const {
    if (homogeneous_) {
      return {knots_.front().albedo, 0.0, &knots_.front().phase, &knots_.front().phase};
    }
    return at_depth(tau() - t);
  }
  LocalScattering at_depth(double depth) const;

 private:
  std::vector<Knot> knots_;
  std::vector<bool> keeps_phase_;
  bool homogeneous_ = false;
  bool isotropic_ = false;
  double ground_ = 0.0;
};

}  // namespace lamina
