// SPDX-License-Identifier: GPL-3.0-or-later
// A phase function of any kind.
#pragma once
#include <Eigen/Core>
#include <utility>
#include <variant>

#include "phase/mixture.hpp"

namespace lamina {

/// The kinds of a variant, and a mixture of them.
template <typename Single>
struct WithMixture;
template <typename... Single>
struct WithMixture<std::variant<Single...>> {
  using Type = std::variant<Single..., Mixture>;
};

/// A phase function p(cos), azimuthally symmetric. Stored values are 4 pi times the normalised density,
/// so that the mean over the sphere is 1. Each kind offers
///   evaluate(cosine)  4 pi p, cosine = w_in . w_out with both along the direction of travel;
///   moment(l)         chi_l = mean of P_l(cosine) p, chi_0 = 1, chi_1 = mean cosine, l up to kMostMoments;
///   peak()            q in [0, 1) with |chi_l| <= q^l in the limit, the decay rate of the moments;
///   sample(u)         the cosine for a uniform u in [0, 1), distributed exactly as pdf.
class PhaseFunction {
 public:
  using Kind = WithMixture<SinglePhase>::Type;

  PhaseFunction() = default;
  PhaseFunction(Kind kind) : kind_(std::move(kind)) {}

  double evaluate(double cosine) const {
    return std::visit([&](const auto& p) { return p.evaluate(cosine); }, kind_);
  }
  /// evaluate() for many cosines, in place.
  void evaluate_all(Eigen::ArrayXd& cosines) const {
    std::visit([&](const auto& p) { cosines = cosines.unaryExpr([&](double c) { return p.evaluate(c); }); }, kind_);
  }
  double moment(int order) const {
    return std::visit([&](const auto& p) { return p.moment(order); }, kind_);
  }
  double peak() const {
    return std::visit([](const auto& p) { return p.peak(); }, kind_);
  }
  /// True if the value is the same in all directions.
  bool is_isotropic() const {
    const auto* lobe = std::get_if<HenyeyGreenstein>(&kind_);
    return std::holds_alternative<Isotropic>(kind_) || (lobe != nullptr && lobe->g == 0.0);
  }
  double sample(double u) const {
    return std::visit([&](const auto& p) { return p.sample(u); }, kind_);
  }

  /// The Henyey-Greenstein function if it is one, else null; for loops over many cosines.
  const HenyeyGreenstein* as_henyey_greenstein() const { return std::get_if<HenyeyGreenstein>(&kind_); }

  /// Calls `use` with the function's concrete type, so that loops do not dispatch at every step.
  template <typename Use>
  auto visit(const Use& use) const {
    return std::visit(use, kind_);
  }

  /// Density of sample() over the cosine; the density over solid angle is pdf / (2 pi).
  double pdf(double cosine) const { return 0.5 * evaluate(cosine); }

 private:
  Kind kind_;
};

}  // namespace lamina
