// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/lobe_family.hpp"

#include "fit/oriented_lobe.hpp"

#include <algorithm>
#include <cmath>

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kLeastLogAlpha = -4.6;  // alpha .01
constexpr double kMostSqueeze = 3.0;
constexpr double kMostAway = 0.5;  // of -k, as a share of the view cosine
constexpr double kMostTilt = 0.6;  // radians
constexpr double kMostK = 3.5;     // larger than all results of most_k: lobes with a larger k lie about the viewer
// The unknown of a lobe about the viewer is kRetro + ln k. Its normal points almost along the view.
constexpr double kRetro = 100.0;
constexpr double kLeastRetro = kRetro + 1.3;  // k 3.7
constexpr double kMostRetro = kRetro + 6.9;   // k 992
constexpr double kStartRetro = kRetro + 4.0;
// Widths of lobes along the normal, to begin with.
constexpr double kLeastWidth = 0.01;
constexpr double kMostWidth = 0.7;
constexpr Index kWidths = 14;
// The same of oriented lobes, each round, and longer by kStartSqueeze along either axis.
constexpr double kLeastOriented = 0.03;
constexpr Index kOrientedWidths = 7;
constexpr double kStartSqueeze = 0.7;

double width(Index step, Index count, double least) {
  return std::log(least) + std::log(kMostWidth / least) * static_cast<double>(step) / static_cast<double>(count - 1);
}

double sine_of(double mu_o) { return std::sqrt(std::max(1e-6, 1.0 - mu_o * mu_o)); }

// The largest |k| whose tilt is at most kMostTilt.
double most_k(double mu_o) {
  const double sine = sine_of(mu_o);
  const double tangent = std::tan(kMostTilt);
  const double left = sine - tangent * mu_o;
  return left > 0.3 * sine ? std::min(tangent / left, 3.0) : 3.0;
}

class MovingFamily final : public LobeFamily {
 public:
  [[nodiscard]] Index unknowns() const override { return 3; }
  [[nodiscard]] Index tilts() const override { return 1; }
  [[nodiscard]] std::vector<Index> odd() const override { return {}; }
  [[nodiscard]] bool is_round_at_normal() const override { return true; }

  [[nodiscard]] VectorXd shape(const double* p) const override {
    const LobeShape shape = shape_of(p);
    return Eigen::Vector3d(shape.roughness, shape.anisotropy, shape.tilt);
  }

  [[nodiscard]] VectorXd unknowns_of(const double* shape) const override {
    const double anisotropy = shape[1];
    const double squeeze = anisotropy > 0.0 ? std::log(1.0 - anisotropy) : -std::log(1.0 + anisotropy);
    const double k = shape[2];
    return Eigen::Vector3d(2.0 * std::log(shape[0]), squeeze, k > kMostK ? kRetro + std::log(k) : k);
  }

  void values(const double* p, double mu_o, double /*phi_o*/, const LightDirections& light,
              Eigen::Ref<VectorXd> out) const override {
    MovingLobe(shape_of(p), mu_o).values(light, out);
  }

  void clamp(double* p, double mu_o) const override {
    p[0] = std::clamp(p[0], kLeastLogAlpha, -1e-3);
    // Neither width above 1
    p[1] = std::clamp(p[1], std::max(-kMostSqueeze, p[0]), std::min(kMostSqueeze, -p[0]));
    // The tilted normal faces the viewer
    p[2] =
        p[2] > kMostK ? std::clamp(p[2], kLeastRetro, kMostRetro) : std::clamp(p[2], -kMostAway * mu_o, most_k(mu_o));
  }

  [[nodiscard]] std::vector<VectorXd> starts(bool retro) const override {
    std::vector<VectorXd> found;
    for (Index step = 0; step < kWidths; ++step) {
      found.emplace_back(Eigen::Vector3d(width(step, kWidths, kLeastWidth), 0.0, 0.0));
      if (retro) found.emplace_back(Eigen::Vector3d(width(step, kWidths, kLeastWidth), 0.0, kStartRetro));
    }
    return found;
  }

 private:
  static LobeShape shape_of(const double* p) {
    const double squeeze = std::exp(-std::abs(p[1]));
    const double alpha = std::exp(p[0]);
    const double k = p[2] > kMostK ? std::exp(p[2] - kRetro) : p[2];
    return {std::sqrt(std::min(alpha, 1.0)), p[1] < 0.0 ? 1.0 - squeeze : squeeze - 1.0, k};
  }
};

class OrientedFamily final : public LobeFamily {
 public:
  [[nodiscard]] Index unknowns() const override { return 5; }
  [[nodiscard]] Index tilts() const override { return 2; }
  [[nodiscard]] std::vector<Index> odd() const override { return {2, 4}; }
  [[nodiscard]] bool is_round_at_normal() const override { return false; }

  [[nodiscard]] VectorXd shape(const double* p) const override {
    const OrientedShape shape = shape_of(p);
    VectorXd numbers(5);
    numbers << shape.roughness, shape.along, shape.across, shape.tilt, shape.aside;
    return numbers;
  }

  [[nodiscard]] VectorXd unknowns_of(const double* shape) const override {
    const double anisotropy = std::hypot(shape[1], shape[2]);
    const double scale = anisotropy > 1e-9 ? -std::log(1.0 - anisotropy) / anisotropy : 1.0;
    VectorXd p(5);
    p << 2.0 * std::log(shape[0]), scale * shape[1], scale * shape[2], shape[3], shape[4];
    return p;
  }

  void values(const double* p, double mu_o, double phi_o, const LightDirections& light,
              Eigen::Ref<VectorXd> out) const override {
    OrientedLobe(shape_of(p), mu_o, phi_o).values(light, out);
  }

  void clamp(double* p, double mu_o) const override {
    p[0] = std::clamp(p[0], kLeastLogAlpha, -1e-3);
    // No width above 1
    const double squeeze = std::hypot(p[1], p[2]);
    const double most = std::min(kMostSqueeze, -p[0]);
    if (squeeze > most) {
      p[1] *= most / squeeze;
      p[2] *= most / squeeze;
    }
    // The tilted normal faces the viewer
    p[3] = std::clamp(p[3], -kMostAway * mu_o, most_k(mu_o));
    const double aside = std::min(3.0, std::tan(kMostTilt) * (1.0 + p[3] * mu_o) / sine_of(mu_o));
    p[4] = std::clamp(p[4], -aside, aside);
  }

  [[nodiscard]] std::vector<VectorXd> starts(bool /*retro*/) const override {
    std::vector<VectorXd> found;
    for (Index step = 0; step < kOrientedWidths; ++step)
      for (const double squeeze : {0.0, kStartSqueeze, -kStartSqueeze}) {
        found.emplace_back(VectorXd::Zero(5));
        found.back().head(2) << width(step, kOrientedWidths, kLeastOriented), squeeze;
      }
    return found;
  }

 private:
  static OrientedShape shape_of(const double* p) {
    const double squeeze = std::hypot(p[1], p[2]);
    const double scale = squeeze > 1e-9 ? (1.0 - std::exp(-squeeze)) / squeeze : 1.0;
    return {std::sqrt(std::min(std::exp(p[0]), 1.0)), scale * p[1], scale * p[2], p[3], p[4]};
  }
};

}  // namespace

const LobeFamily& moving_family() {
  static const MovingFamily family;
  return family;
}

const LobeFamily& oriented_family() {
  static const OrientedFamily family;
  return family;
}

}  // namespace lamina
