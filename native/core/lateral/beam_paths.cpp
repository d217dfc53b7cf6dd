// SPDX-License-Identifier: GPL-3.0-or-later
#include "lateral/beam_paths.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lateral/fine_quadrature.hpp"
#include "matter/fresnel.hpp"
#include "numeric/bessel.hpp"
#include "operators/base_reflection.hpp"
#include "operators/delta_field.hpp"
#include "operators/interface.hpp"

namespace lamina {
namespace {

using Eigen::Index;

/// The delta parts of all layers for the beam; the base comes last.
std::vector<ScatteringFunction> delta_layers(const LateralStack& stack) {
  const std::vector<Directions>& directions = stack.directions();
  const std::vector<Layer>& layers = stack.measured().stack.layers;
  std::vector<ScatteringFunction> functions;
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    const Directions& here = directions[layer];
    const auto* interface = std::get_if<Interface>(&layers[layer]);
    if (interface == nullptr) {
      ScatteringFunction direct = ScatteringFunction::bare(here.size(), here.nodes);
      const double tau = stack.media()[layer] ? stack.media()[layer]->medium().tau : 0.0;
      direct.transmit.delta = here.spread(direct_transmissions(here.mu, tau));
      functions.push_back(std::move(direct));
    } else if (interface->is_rough(here.ior)) {
      functions.push_back(ScatteringFunction::bare(here.size(), here.nodes));
    } else {
      functions.push_back(smooth_interface(here, directions[layer + 1], interface->optics(here.ior)));
    }
  }
  const Base& base = stack.measured().stack.base;
  const Directions& bottom = directions.back();
  if (base.kind != Base::Kind::kNone) {
    functions.push_back(base_deltas(base, bottom));
  }
  return functions;
}

/// The medium next to a face and the smooth boundaries between both; no medium if light is scattered elsewhere first.
struct NextMedium {
  std::size_t layer = 0;
  std::vector<double> indices;  ///< refractive indices from the medium outwards
};

std::optional<NextMedium> next_medium(const LateralStack& stack, bool top) {
  const std::vector<Layer>& layers = stack.measured().stack.layers;
  const std::vector<Directions>& directions = stack.directions();
  NextMedium next;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    next.layer = top ? k : layers.size() - 1 - k;
    if (const auto* interface = std::get_if<Interface>(&layers[next.layer])) {
      if (interface->is_rough(directions[next.layer].ior)) {
        return std::nullopt;
      }
      next.indices.insert(next.indices.begin(), directions[top ? next.layer : next.layer + 1].ior);
    } else if (const auto& medium = stack.media()[next.layer]) {
      if (!medium->scatters()) {
        return std::nullopt;
      }
      next.indices.insert(next.indices.begin(), directions[next.layer].ior);
      return next;
    }
  }
  return std::nullopt;
}

/// The share of light at cosine `mu` in the first medium that passes all smooth boundaries into the last medium.
double passing(const std::vector<double>& indices, double mu) {
  double reflected = 0.0;
  double passed = 1.0;
  double cosine = mu;
  for (std::size_t k = 0; k + 1 < indices.size(); ++k) {
    const double next = refracted_cosine(mu, indices.front(), indices[k + 1]);
    if (next <= 0.0) {
      return 0.0;
    }
    const double r = fresnel(cosine, next, indices[k], indices[k + 1]);
    const double between = 1.0 - reflected * r;
    // Combine the boundaries so far into one, as seen from the first medium.
    passed = passed * (1.0 - r) / between;
    reflected = r + (1.0 - r) * (1.0 - r) * reflected / between;
    cosine = next;
  }
  return passed;
}

/// Light below this cosine in the first medium does not reach the last: a medium in between reflects it totally.
double critical_cosine(const std::vector<double>& indices) {
  double critical = 0.0;
  for (const double ior : indices) {
    if (ior < indices.front()) {
      critical = std::max(critical, refracted_cosine(0.0, ior, indices.front()));
    }
  }
  return critical;
}

/// The beam at the faces of a layer, for light that leaves the stack at the top or at the bottom.
OnceScatteredBeam::Beam arriving(const DeltaField& field, std::size_t layer, Index beam, bool top) {
  const double down = field.from_above[layer].down[beam];
  const double up = field.from_above[layer].up[beam];
  return top ? OnceScatteredBeam::Beam{down, up} : OnceScatteredBeam::Beam{up, down};
}

std::optional<OnceScatteredBeam> once_scattered(const LateralStack& stack, bool top) {
  if (!stack.along_normal()) {
    return std::nullopt;
  }
  const std::optional<NextMedium> next = next_medium(stack, top);
  if (!next) {
    return std::nullopt;
  }
  const DeltaField field(delta_layers(stack));
  const Index beam = stack.directions().front().nodes;
  return OnceScatteredBeam(
      *stack.media()[next->layer], stack.directions()[next->layer], arriving(field, next->layer, beam, top),
      [indices = next->indices](double mu) { return passing(indices, mu); }, critical_cosine(next->indices));
}

/// The share of light that passes the smooth boundaries from the first medium to the last, without reflections between
/// boundaries.
double passing_once(const std::vector<double>& indices, double mu) {
  double passed = 1.0;
  double cosine = mu;
  for (std::size_t k = 0; k + 1 < indices.size(); ++k) {
    const double next = refracted_cosine(mu, indices.front(), indices[k + 1]);
    if (next <= 0.0) {
      return 0.0;
    }
    passed *= 1.0 - fresnel(cosine, next, indices[k], indices[k + 1]);
    cosine = next;
  }
  return passed;
}

std::vector<OnceScatteredBeam> deeper_scattered(const LateralStack& stack, bool top) {
  std::vector<OnceScatteredBeam> found;
  const std::vector<Layer>& layers = stack.measured().stack.layers;
  // A graded medium has too many sublayers for a fine quadrature of each.
  constexpr std::ptrdiff_t kMostMedia = 4;
  const auto media =
      std::count_if(stack.media().begin(), stack.media().end(), [](const auto& m) { return m.has_value(); });
  if (!stack.along_normal() || media > kMostMedia) {
    return found;
  }
  const std::vector<Directions>& directions = stack.directions();
  const DeltaField field(delta_layers(stack));
  const Index beam = directions.front().nodes;
  std::vector<std::size_t> crossed;  // media between a layer and the face
  std::vector<double> indices{top ? directions.front().ior : directions.back().ior};
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const std::size_t layer = top ? k : layers.size() - 1 - k;
    const double ior = directions[layer].ior;
    if (const auto* interface = std::get_if<Interface>(&layers[layer])) {
      if (interface->is_rough(ior)) {
        break;
      }
      indices.insert(indices.begin(), top ? directions[layer + 1].ior : ior);
      continue;
    }
    if (!stack.media()[layer]) {
      continue;
    }
    const LateralMedium& medium = *stack.media()[layer];
    if (medium.scatters() && !crossed.empty()) {
      std::vector<OnceScatteredBeam::Crossed> others;
      for (const std::size_t other : crossed) {
        const LateralMedium& between = *stack.media()[other];
        others.push_back({between.extinction(), between.thickness(), directions[other].ior / ior});
      }
      found.emplace_back(
          medium, directions[layer], arriving(field, layer, beam, top),
          [indices](double mu) { return passing_once(indices, mu); }, critical_cosine(indices), std::move(others));
    }
    if (std::isinf(medium.thickness())) {
      break;
    }
    crossed.push_back(layer);
  }
  return found;
}

}  // namespace

std::vector<OnceScatteredBeam> deeper_scattered_upward(const LateralStack& stack) {
  return deeper_scattered(stack, true);
}

std::vector<OnceScatteredBeam> deeper_scattered_downward(const LateralStack& stack) {
  if (stack.measured().stack.base.kind != Base::Kind::kNone) {
    return {};
  }
  return deeper_scattered(stack, false);
}

std::optional<OnceScatteredBeam> once_scattered_upward(const LateralStack& stack) {
  return once_scattered(stack, true);
}

std::optional<OnceScatteredBeam> once_scattered_downward(const LateralStack& stack) {
  if (stack.measured().stack.base.kind != Base::Kind::kNone) {
    return std::nullopt;
  }
  return once_scattered(stack, false);
}

namespace {

/// The media and boundaries between the surface at a layer and the upper or lower face. Nothing without media, with a
/// half-space, or if a rough boundary lies on the way, except one at the lower face.
std::optional<std::vector<LitSurface::Part>> parts_from(const LateralStack& stack, std::size_t surface, bool up) {
  const std::vector<Layer>& layers = stack.measured().stack.layers;
  const std::vector<Directions>& directions = stack.directions();
  std::vector<LitSurface::Part> parts;
  bool media = false;
  const std::size_t count = up ? surface : layers.size() - std::min(surface + 1, layers.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t layer = up ? surface - 1 - k : surface + 1 + k;
    const double ior = directions[up ? layer : layer + 1].ior;
    if (std::holds_alternative<Interface>(layers[layer])) {
      const LateralStack::Rough* rough = stack.rough(layer);
      if (rough != nullptr && (up || k + 1 < count)) {
        return std::nullopt;
      }
      parts.push_back({ior, 0.0, 0.0, rough != nullptr ? rough->passed[0] : Eigen::VectorXd()});
    } else if (const auto& medium = stack.media()[layer]) {
      if (std::isinf(medium->thickness())) {
        return std::nullopt;
      }
      parts.push_back({ior, medium->thickness(), medium->extinction(), {}});
      media = true;
    }
  }
  return media ? std::optional(std::move(parts)) : std::nullopt;
}

/// How a Lambert base, or the facets of a surface, spread the beam upwards or downwards.
LitSurface::Spread spread_at(const LateralStack& stack, std::size_t surface, bool up) {
  const Directions& here = stack.directions()[up ? surface : surface + 1];
  const Eigen::VectorXd by_cosine = here.mu.head(here.live).cwiseProduct(here.weight.head(here.live));
  if (const LateralStack::Rough* rough = stack.rough(surface)) {
    const auto lobe = [rough, up, square = here.ior * here.ior](double mu) {
      const Face to = up ? Face::kTop : Face::kBottom;
      const double value = rough->surface->value(Face::kTop, to, 1.0, mu, Eigen::ArrayXd::Ones(1))[0];
      return 2.0 * std::numbers::pi * square * mu * value;
    };
    const std::size_t side = up ? 0 : 1;
    return {rough->spread[side], lobe, rough->repeated[side].cwiseQuotient(by_cosine)};
  }
  const double reflectance = stack.measured().stack.base.reflectance;
  return {2.0 * reflectance * by_cosine, [](double) { return 0.0; },
          Eigen::VectorXd::Constant(here.live, 2.0 * reflectance), 1.0};
}

}  // namespace

std::vector<LitSurface> lit_surfaces(const LateralStack& stack, bool up) {
  std::vector<LitSurface> found;
  const Base& base = stack.measured().stack.base;
  const std::size_t layers = stack.measured().stack.layers.size();
  std::size_t surface = 0;
  while (surface < layers && stack.rough(surface) == nullptr) {
    ++surface;
  }
  const bool is_lambert = surface == layers && base.kind == Base::Kind::kLambert && base.reflectance > 0.0;
  if (!stack.along_normal() || !(is_lambert || stack.rough(surface) != nullptr)) {
    return found;
  }
  const DeltaField field(delta_layers(stack));
  const double beam = field.from_above[surface].down[stack.directions().front().nodes];
  const auto add = [&](bool upwards, Eigen::VectorXd echoed) {
    if (auto parts = parts_from(stack, surface, upwards)) {
      LitSurface::Spread spread = spread_at(stack, surface, upwards);
      spread.echoed = std::move(echoed);
      found.emplace_back(stack.directions()[upwards ? surface : surface + 1], beam, std::move(spread),
                         std::move(*parts));
    }
  };
  if (up) {
    add(true, {});
  } else if (base.kind == Base::Kind::kNone && surface < layers) {
    add(false, {});
  }
  if (up && surface == 0 && layers > 0) {
    add(false, stack.rough(surface)->passed[1]);
  }
  return found;
}

namespace {

/// Light of the beam between two layers, on a specular path.
struct SpecularLight {
  std::size_t gap;  // light is above this layer
  bool down;
  double flux;
  double direct;  // without light of truncated peaks
  double radius;  // distance from the point of entry
};

/// Follows the specular paths of an oblique beam with at least 1e-9 of its power, and calls `visit` for each light.
template <typename Visit>
void follow_specular_paths(const LateralStack& stack, const Visit& visit) {
  constexpr double kFaintest = 1e-9;
  const std::vector<ScatteringFunction> layers = delta_layers(stack);
  const Index beam = stack.directions().front().nodes;
  std::vector<SpecularLight> waiting{{0, true, 1.0, 1.0, 0.0}};
  while (!waiting.empty()) {
    const SpecularLight light = waiting.back();
    waiting.pop_back();
    if (light.flux < kFaintest) {
      continue;
    }
    visit(light);
    if (light.gap == (light.down ? layers.size() : 0)) {
      continue;
    }
    const std::size_t layer = light.down ? light.gap : light.gap - 1;
    const ScatteringFunction& function = layers[layer];
    double radius = light.radius;
    double peaks = 1.0;
    if (layer < stack.media().size() && stack.media()[layer]) {
      const Directions& here = stack.directions()[layer];
      const double mu = here.mu[here.live];
      radius += stack.media()[layer]->thickness() * std::sqrt(1.0 - mu * mu) / mu;
      peaks = std::exp(-stack.media()[layer]->truncated_tau() / mu);
    }
    const double mirrored = (light.down ? function.reflect_above : function.reflect_below).delta[beam];
    const double passed = function.transmit.delta[beam];
    waiting.push_back({light.gap, !light.down, mirrored * light.flux, mirrored * light.direct, light.radius});
    waiting.push_back(
        {light.down ? layer + 1 : layer, light.down, passed * light.flux, passed * peaks * light.direct, radius});
  }
}

}  // namespace

Rings unscattered_rings(const LateralStack& stack) {
  Rings rings;
  if (stack.along_normal()) {
    return rings;
  }
  const bool open = stack.measured().stack.base.kind == Base::Kind::kNone;
  const std::size_t bottom = stack.measured().stack.layers.size() + (open ? 0 : 1);
  follow_specular_paths(stack, [&](const SpecularLight& light) {
    if (light.radius > 0.0 && light.gap == (light.down ? bottom : 0)) {
      (light.down ? rings.transmitted : rings.reflected).push_back({light.radius, light.flux, light.direct});
    }
  });
  return rings;
}

std::optional<ObliqueScattering> oblique_scattering(const LateralStack& stack, bool top) {
  if (stack.along_normal() || (!top && stack.measured().stack.base.kind != Base::Kind::kNone)) {
    return std::nullopt;
  }
  const std::optional<NextMedium> next = next_medium(stack, top);
  if (!next) {
    return std::nullopt;
  }
  constexpr double kFaintest = 1e-3;  // the singularities of fainter light are not seen
  std::vector<BeamWay> ways;
  follow_specular_paths(stack, [&](const SpecularLight& light) {
    if (light.flux >= kFaintest && light.gap == next->layer + (light.down ? 0 : 1)) {
      ways.push_back({light.radius, light.flux, light.down == top});
    }
  });
  return ObliqueScattering(
      *stack.media()[next->layer], stack.directions()[next->layer], std::move(ways),
      [indices = next->indices](double mu) { return passing(indices, mu); }, critical_cosine(next->indices));
}

ForwardPeaks::ForwardPeaks(const LateralStack& stack, int legs) {
  if (!stack.along_normal()) {
    return;
  }
  const std::vector<std::optional<LateralMedium>>& media = stack.media();
  std::vector<std::size_t> way;
  for (std::size_t layer = 0; layer < media.size(); ++layer) {
    if (media[layer] && !std::isinf(media[layer]->thickness())) {
      way.push_back(layer);
    }
  }
  if (legs == 2) {
    way.insert(way.end(), way.rbegin(), way.rend());
  }
  const Nodes cosines = between_cosines(0.0);
  const Nodes depths = graded(0.0, 1.0, 1.0, false);
  // A peak is the difference of two phase functions, with an error of about 1e-13. Fainter peaks stay unscattered.
  constexpr double kFaintest = 1e-8;
  for (std::size_t k = 0; k < way.size(); ++k) {
    const LateralMedium& medium = *media[way[k]];
    const TruncatedMedium& truncated = medium.medium();
    if (!medium.scatters() || truncated.forward_share < kFaintest) {
      continue;
    }
    const double scattering = medium.extinction() * truncated.single_scattering_albedo() * medium.thickness();
    const double ior = stack.directions()[way[k]].ior;
    for (std::size_t c = 0; c < cosines.place.size(); ++c) {
      const double mu = cosines.place[c];
      const double peak =
          medium.phase().evaluate(mu) - (1.0 - truncated.forward_share) * truncated_phase(truncated, mu);
      double beyond = 0.0;
      bool passes = true;
      const auto slope = [&](std::size_t layer) {
        const double other = refracted_cosine(mu, ior, stack.directions()[layer].ior);
        passes = passes && other > 0.0;
        return passes ? std::sqrt(1.0 - other * other) / other : 0.0;
      };
      for (std::size_t later = k + 1; later < way.size(); ++later) {
        beyond += media[way[later]]->thickness() * slope(way[later]);
      }
      if (!passes) {
        continue;
      }
      for (std::size_t d = 0; d < depths.place.size(); ++d) {
        terms_.push_back({0.5 * scattering * cosines.weight[c] * depths.weight[d] * peak,
                          beyond + depths.place[d] * medium.thickness() * slope(way[k])});
      }
    }
  }
}

double ForwardPeaks::at(double q) const {
  const auto spread = [&](double frequency) {
    double sum = 0.0;
    for (const Term& term : terms_) {
      sum += term.weight * bessel_j0(frequency * term.distance);
    }
    return sum;
  };
  // The number of peak scatterings has a Poisson distribution; leave out the light with none.
  return std::expm1(spread(q)) / std::expm1(spread(0.0));
}

}  // namespace lamina
