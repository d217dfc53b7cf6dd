// SPDX-License-Identifier: GPL-3.0-or-later
// A weighted sum of phase functions, for several sorts of particles in one medium.
#pragma once
#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "phase/cornette_shanks.hpp"
#include "phase/double_henyey_greenstein.hpp"
#include "phase/draine.hpp"
#include "phase/henyey_greenstein.hpp"
#include "phase/isotropic.hpp"
#include "phase/moment_decay.hpp"
#include "phase/rayleigh.hpp"
#include "phase/tabulated.hpp"

namespace lamina {

/// The phase functions of one sort of particles. Each except Tabulated has a name, kKind, and the number of its
/// constructor's parameters, kParameters; the Python binding constructs them by these.
using SinglePhase =
    std::variant<Isotropic, HenyeyGreenstein, Rayleigh, DoubleHenyeyGreenstein, Draine, CornetteShanks, Tabulated>;

/// A sum of phase functions, each weighted by its sort's share of the scattering coefficient. Shares are not negative
/// and are scaled to sum to 1.
class Mixture {
 public:
  struct Part {
    double share;
    SinglePhase phase;
  };

  explicit Mixture(std::vector<Part> parts) : parts_(std::move(parts)) {
    double whole = 0.0;
    for (const Part& part : parts_) {
      whole += part.share;
    }
    for (Part& part : parts_) {
      part.share /= whole;
    }
  }

  const std::vector<Part>& parts() const { return parts_; }

  double evaluate(double cosine) const {
    return sum([cosine](const auto& phase) { return phase.evaluate(cosine); });
  }
  double moment(int order) const {
    return sum([order](const auto& phase) { return phase.moment(order); });
  }
  double peak() const { return measured_peak(*this); }

  /// u chooses the sort of particle and, rescaled, the cosine.
  double sample(double u) const {
    double rest = u;
    const Part* chosen = nullptr;
    double within = 0.0;
    for (const Part& part : parts_) {
      if (part.share <= 0.0) {
        continue;
      }
      chosen = &part;
      within = std::min(rest / part.share, 1.0);
      if (rest <= part.share) {
        break;
      }
      rest -= part.share;
    }
    return std::visit([within](const auto& phase) { return phase.sample(within); }, chosen->phase);
  }

 private:
  template <typename Value>
  double sum(const Value& value) const {
    double total = 0.0;
    for (const Part& part : parts_) {
      total += part.share * std::visit(value, part.phase);
    }
    return total;
  }

  std::vector<Part> parts_;
};

}  // namespace lamina
