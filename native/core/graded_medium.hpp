// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "phase/phase.hpp"

namespace lamina {

/// What scatters at one depth: k(cosine) = first p(cosine) + second q(cosine), the albedo times 4 pi the phase
/// function's density.
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
  /// The same for many cosines at once, in single precision.
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

  /// The cosine for a uniform u in (0, 1), distributed as evaluate(cosine) / (2 albedo).
  double sample(double u) const {
    const double share = second > 0.0 ? first / (first + second) : 1.0;
    return u < share ? p->sample(u / share) : q->sample((u - share) / (1.0 - share));
  }
};

/// A slab whose properties vary with depth. Between knots, albedo times phase function varies linearly with the
/// optical depth.
class GradedMedium {
 public:
  struct Knot {
    double tau = 0.0;     ///< optical depth below the top
    double albedo = 0.0;  ///< [0, 1]
    PhaseFunction phase;
  };

  /// Knots from the top, tau 0, to the bottom; tau ascends strictly. Throws std::invalid_argument otherwise.
  explicit GradedMedium(std::vector<Knot> knots);
  static GradedMedium homogeneous(double albedo, double tau, const PhaseFunction& phase);

  double tau() const { return knots_.back().tau; }
  bool is_homogeneous() const { return homogeneous_; }
  bool is_isotropic() const { return isotropic_; }
  const std::vector<Knot>& knots() const { return knots_; }

  /// What scatters at the optical height t above the bottom.
  LocalScattering at(double t) const {
    if (homogeneous_) {
      return {knots_.front().albedo, 0.0, &knots_.front().phase, &knots_.front().phase};
    }
    return between(t);
  }

 private:
  LocalScattering between(double t) const;

  std::vector<Knot> knots_;
  bool homogeneous_ = false;
  bool isotropic_ = false;
};

}  // namespace lamina
