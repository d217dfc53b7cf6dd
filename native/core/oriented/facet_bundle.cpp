// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/facet_bundle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numeric/quadrature.hpp"

namespace lamina {

using std::numbers::pi;

Heading Heading::of(double mu, double cosine, double sine) {
  const double flat = std::sqrt(std::max(0.0, 1.0 - mu * mu));
  return {flat * cosine, flat * sine, mu};
}

FacetBundle::FacetBundle(const Facets& facets, int fineness) : facets_(facets), circles_(fineness) {
  for (int count = 0; count <= 2 * fineness; ++count) {
    panels_.emplace_back(count);
  }
}

namespace {

struct Normal {
  double x;
  double y;
  double z;
};

/// Light from one direction at the facets, and where the rays go.
class Scattering {
 public:
  Scattering(const Facets& facets, const FacetOptics& optics, const FacetEnds& ends, const Heading& in)
      : facets_(facets),
        optics_(optics),
        ends_(ends),
        x_(-in.x),
        y_(-in.y),
        mu_(in.mu),
        ratio_(optics.ratio()),
        hidden_(facets.lambda(x_, y_, mu_)),
        critical_(ratio_ < 1.0 ? std::sqrt(1.0 - ratio_ * ratio_) : 0.0) {}

  /// Values that change sign where the scattered light is not smooth.
  void signs(const Normal& h, std::vector<double>& values) const {
    const double cosine = x_ * h.x + y_ * h.y + mu_ * h.z;
    values.clear();
    values.push_back(cosine);
    for (const double end : ends_.here) {
      values.push_back(2.0 * cosine * h.z - mu_ - end);
    }
    if (optics_.metal) {
      return;
    }
    const double along = cosine / ratio_ - std::sqrt(std::max(0.0, refracted(cosine)));
    for (const double end : ends_.beyond) {
      values.push_back(mu_ / ratio_ - along * h.z - end);
    }
    if (critical_ > 0.0) {
      values.push_back(cosine - critical_);
    }
  }

  /// Adds the rays of a facet; returns the share that is not hidden.
  double add(const Normal& h, double weight, RayList& reflected, RayList& transmitted) const {
    const double cosine = std::min(1.0, x_ * h.x + y_ * h.y + mu_ * h.z);
    if (cosine <= 0.0) {
      return 0.0;
    }
    double kept = 0.0;
    const double fresnel = optics_.reflectance(cosine);
    const double up = 2.0 * cosine * h.z - mu_;
    if (up > 0.0) {
      const Heading out{2.0 * cosine * h.x - x_, 2.0 * cosine * h.y - y_, std::min(1.0, up)};
      const double shown = weight * (1.0 + hidden_) * facets_.masked(hidden_, facets_.lambda(out.x, out.y, out.mu));
      reflected.add(fresnel * shown, out);
      kept += (optics_.metal ? 1.0 : fresnel) * shown;
    }
    const double square = refracted(cosine);
    if (optics_.metal || square <= 0.0) {
      return kept;
    }
    const double along = cosine / ratio_ - std::sqrt(square);
    const double down = mu_ / ratio_ - along * h.z;
    if (down > 0.0) {
      const Heading out{along * h.x - x_ / ratio_, along * h.y - y_ / ratio_, std::min(1.0, down)};
      const double shown = weight * (1.0 + hidden_) * facets_.passed(hidden_, facets_.lambda(out.x, out.y, out.mu));
      const double passed = optics_.transmittance(cosine) * shown;
      transmitted.add(passed, out);
      kept += passed;
    }
    return kept;
  }

 private:
  double refracted(double cosine) const { return 1.0 - (1.0 - cosine * cosine) / (ratio_ * ratio_); }

  const Facets& facets_;
  const FacetOptics& optics_;
  const FacetEnds& ends_;
  double x_;
  double y_;
  double mu_;
  double ratio_;
  double hidden_;
  double critical_;
};

/// The facets that one ray sees, as circles numbered by `across` in (0, 1), denser where facets are steep.
class Circles {
 public:
  Circles(const Facets& facets, const Heading& in)
      : is_ggx_(facets.distribution == Facets::Distribution::kGgx),
        cosine_(std::cos(facets.angle)),
        sine_(std::sin(facets.angle)),
        along_(facets.alpha),
        aside_(facets.across()) {
    // The direction towards the light as facets of width 1 see it.
    const double u = -along_ * (cosine_ * in.x + sine_ * in.y);
    const double v = -aside_ * (cosine_ * in.y - sine_ * in.x);
    const double length = std::sqrt(u * u + v * v + in.mu * in.mu);
    u_ = u / length;
    v_ = v / length;
    w_ = in.mu / length;
  }

  /// GGX: facets of width 1 reflect light uniformly over a cap of the sphere (Dupuy and Benyoub 2023), in circles about
  /// the normal. Beckmann: circles of equal slope, of which a steep ray sees parts.
  Normal facet(double across, double turn) const {
    if (is_ggx_) {
      const double height = (1.0 + w_) * across * across;
      const double up = height - w_;
      const double out = std::sqrt(std::max(0.0, 1.0 - up * up));
      return normal(out * std::cos(turn) + u_, out * std::sin(turn) + v_, height);
    }
    const double slope = steepness(across);
    return normal(slope * std::cos(turn), slope * std::sin(turn), 1.0);
  }
  /// The density of visible facets, up to a factor.
  double density(double across, double turn) const {
    const double slope = steepness(across);
    return across * (is_ggx_ ? 1.0 : std::max(0.0, w_ + slope * (u_ * std::cos(turn) + v_ * std::sin(turn))));
  }

 private:
  static double steepness(double across) { return std::sqrt(-2.0 * std::log(across)); }
  Normal normal(double a, double b, double upright) const {
    const double p = along_ * a;
    const double q = aside_ * b;
    const double norm = 1.0 / std::sqrt(p * p + q * q + upright * upright);
    return {norm * (cosine_ * p - sine_ * q), norm * (sine_ * p + cosine_ * q), norm * upright};
  }

  bool is_ggx_;
  double cosine_;
  double sine_;
  double along_;
  double aside_;
  double u_ = 0.0;
  double v_ = 0.0;
  double w_ = 1.0;
};

/// The places on a circle where the scattered light is not smooth.
class Stops {
 public:
  Stops(const Scattering& scattering, const Circles& circles, int count)
      : scattering_(scattering), circles_(circles), count_(count), step_(2.0 * pi / count) {}

  /// Ascending, found between neighbours of equidistant places.
  std::vector<double> places(double across) {
    std::vector<double> found;
    scattering_.signs(circles_.facet(across, 0.5 * step_), first_);
    here_ = first_;
    for (int j = 0; j < count_; ++j) {
      const double from = (j + 0.5) * step_;
      if (j + 1 < count_) {
        scattering_.signs(circles_.facet(across, from + step_), next_);
      } else {
        next_ = first_;
      }
      for (std::size_t k = 0; k < here_.size(); ++k) {
        if ((here_[k] > 0.0) != (next_[k] > 0.0)) {
          found.push_back(zero(across, from, k, here_[k], next_[k]));
        }
      }
      here_.swap(next_);
    }
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  /// By the rule of false position, in Illinois form.
  double zero(double across, double from, std::size_t k, double at_a, double at_b) {
    double a = from;
    double b = from + step_;
    for (int round = 0; round < 40 && b - a > 1e-10 * step_; ++round) {
      const double c = std::clamp((a * at_b - b * at_a) / (at_b - at_a), a, b);
      scattering_.signs(circles_.facet(across, c), middle_);
      if (std::abs(middle_[k]) < 1e-13) {
        return c;
      }
      if ((middle_[k] > 0.0) == (at_b > 0.0)) {
        b = c;
        at_b = middle_[k];
        at_a *= 0.5;
      } else {
        a = c;
        at_a = middle_[k];
        at_b *= 0.5;
      }
    }
    return 0.5 * (a + b);
  }

  const Scattering& scattering_;
  const Circles& circles_;
  int count_;
  double step_;
  std::vector<double> first_;
  std::vector<double> here_;
  std::vector<double> next_;
  std::vector<double> middle_;
};

}  // namespace

double FacetBundle::scatter(const Heading& in, const FacetOptics& optics, const FacetEnds& ends, RayList& reflected,
                            RayList& transmitted) const {
  for (RayList* list : {&reflected, &transmitted}) {
    list->share.clear();
    list->ray.clear();
  }
  const Scattering scattering(facets_, optics, ends, in);
  const Circles circles(facets_, in);
  const int count = 2 * circles_;
  Stops stops(scattering, circles, count);
  double kept = 0.0;
  double sum = 0.0;
  const auto add_circle = [&](double across, double size) {
    const auto add = [&](double turn, double share) {
      const double weight = size * share * circles.density(across, turn);
      sum += weight;
      kept += scattering.add(circles.facet(across, turn), weight, reflected, transmitted);
    };
    std::vector<double> places = stops.places(across);
    if (places.empty()) {
      for (int j = 0; j < count; ++j) {
        add(2.0 * pi * (j + 0.5) / count, 1.0 / count);
      }
      return;
    }
    places.push_back(places.front() + 2.0 * pi);
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
      const double share = (places[k + 1] - places[k]) / (2.0 * pi);
      const auto wanted = static_cast<std::size_t>(std::clamp(static_cast<int>(std::ceil(share * count)), 5, count));
      const Quadrature& rule = panels_[wanted];
      for (Eigen::Index p = 0; p < rule.mu.size(); ++p) {
        add(places[k] + 2.0 * pi * share * rule.mu[p], share * rule.weight[p]);
      }
    }
  };
  const Quadrature& across = panels_[static_cast<std::size_t>(circles_)];
  for (Eigen::Index k = 0; k < across.mu.size(); ++k) {
    add_circle(across.mu[k], across.weight[k]);
  }
  for (RayList* list : {&reflected, &transmitted}) {
    for (double& share : list->share) {
      share /= sum;
    }
  }
  return kept / sum;
}

double facet_value(const Facets& facets, const FacetOptics& optics, const Heading& in, const Heading& out,
                   bool beyond) {
  const double hidden = facets.lambda(in.x, in.y, in.mu);
  const double unseen = facets.lambda(out.x, out.y, out.mu);
  // The half vector; light comes from (-in.x, -in.y, in.mu).
  const double scale = beyond ? -optics.beyond : optics.here;
  double x = -optics.here * in.x * (beyond ? -1.0 : 1.0) + scale * out.x;
  double y = -optics.here * in.y * (beyond ? -1.0 : 1.0) + scale * out.y;
  double z = beyond ? optics.beyond * out.mu - optics.here * in.mu : optics.here * (in.mu + out.mu);
  double length = std::sqrt(x * x + y * y + z * z);
  if (length == 0.0) {
    return 0.0;
  }
  length = z < 0.0 ? -length : length;
  x /= length;
  y /= length;
  z /= length;
  const double cosine = std::min(1.0, in.mu * z - in.x * x - in.y * y);
  if (!beyond) {
    return facets.density(x, y, std::min(1.0, z)) * optics.reflectance(cosine) * facets.masked(hidden, unseen) /
           (4.0 * in.mu * out.mu * optics.here * optics.here);
  }
  const double leaving = out.x * x + out.y * y - out.mu * z;
  if (!(cosine > 0.0 && leaving < 0.0)) {
    return 0.0;
  }
  return facets.density(x, y, std::min(1.0, z)) * optics.transmittance(cosine) * facets.passed(hidden, unseen) *
         -cosine * leaving / (in.mu * out.mu * length * length);
}

}  // namespace lamina
