// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/facet_meetings.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamina {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array kFaces{Face::kTop, Face::kBottom};

/// Factor from a facet's slope to the change of n sin(theta) of a ray, for reflection or refraction.
double turn(double ior_here, double ior_beyond, bool reflects) {
  return reflects ? 2.0 * ior_here : std::abs(ior_beyond - ior_here);
}

/// Cosines on one side at which the directions of a less dense medium end.
std::vector<double> critical_cosines(const std::vector<double>& indices, double ior) {
  std::vector<double> cosines{0.0};
  for (const double other : indices) {
    if (other < ior) {
      cosines.push_back(refracted_cosine(0.0, other, ior));
    }
  }
  std::sort(cosines.begin(), cosines.end());
  cosines.erase(std::unique(cosines.begin(), cosines.end()), cosines.end());
  return cosines;
}

/// The share of a beam from outside that arrives at a face of a layer; by reciprocity, also the share of light from the
/// face that leaves the stack. By direction.
const VectorXd& at_face(const DeltaField::Arrival& arrival, Face face) {
  return face == Face::kTop ? arrival.down : arrival.up;
}

}  // namespace

FacetMeetings::FacetMeetings(const Assembly& assembly) : assembly_(assembly), sections_(assembly.solution()) {
  const Solution& solution = assembly.solution();
  const Stack& stack = solution.stack();
  const std::vector<double> indices = refractive_indices(stack);
  const std::vector<Solution::Boundary>& rough = solution.boundaries();
  // The narrowest lobe: rays of all lobes must be dense enough to sample it.
  double narrowest = 1e300;
  const auto facets = [&](const Solution::Boundary& boundary) -> const Facets& {
    return boundary.layer == stack.layers.size() ? stack.base.facets
                                                 : std::get<Interface>(stack.layers[boundary.layer]).facets;
  };
  const auto each_lobe = [&](const Solution::Boundary& boundary, auto body) {
    const double above = indices[boundary.layer];
    body(turn(above, above, true) * facets(boundary).alpha);
    if (boundary.layer < stack.layers.size()) {
      const double below = indices[boundary.layer + 1];
      body(turn(below, above, true) * facets(boundary).alpha);
      body(turn(above, below, false) * facets(boundary).alpha);
    }
  };
  for (const Solution::Boundary& boundary : rough) {
    each_lobe(boundary, [&](double width) { narrowest = std::min(narrowest, width); });
  }
  for (const Solution::Boundary& boundary : rough) {
    double widest = 0.0;
    each_lobe(boundary, [&](double width) { widest = std::max(widest, width); });
    // In the tail of a lobe, features of a narrower lobe are as wide as the square root of the ratio of both widths.
    constexpr double kDensity = 1.6;
    constexpr int kDegree = 8;
    const double density = kDensity * std::sqrt(widest / narrowest);
    const double above = indices[boundary.layer];
    const bool at_base = boundary.layer == stack.layers.size();
    Boundary made{boundary.layer, at_base ? boundary.layer : boundary.layer + 1, boundary.surface.get(), {}};
    const std::vector<double> own = critical_cosines(indices, above);
    if (at_base) {
      made.rays.emplace_back(stack.base, above, FacetRays::Pieces{kDegree, own, {}, density});
    } else {
      const std::vector<double> other = critical_cosines(indices, indices[boundary.layer + 1]);
      made.rays.emplace_back(facets(boundary), boundary.surface->optics(Face::kTop),
                             FacetRays::Pieces{kDegree, own, other, density});
      made.rays.emplace_back(facets(boundary), boundary.surface->optics(Face::kBottom),
                             FacetRays::Pieces{kDegree, other, own, density});
    }
    boundaries_.push_back(std::move(made));
  }
  for (std::size_t k = 0; k < rough.size(); ++k) {
    meetings_.push_back({k, Face::kTop, k, Face::kTop, k, &Deltas::reflect_below});
    if (exists(k, Face::kBottom)) {
      meetings_.push_back({k, Face::kBottom, k, Face::kBottom, k + 1, &Deltas::reflect_above});
    }
    if (k > 0) {
      meetings_.push_back({k, Face::kTop, k - 1, Face::kBottom, k, &Deltas::transmit});
      meetings_.push_back({k - 1, Face::kBottom, k, Face::kTop, k, &Deltas::transmit});
    }
  }
  // Leave fainter meetings to interpolation through the nodes.
  const double faint = 0.1 * std::min(solution.resolution().tolerance, 1e-2);
  std::erase_if(meetings_, [&](const Meeting& meeting) { return !(between_nodes(meeting) > faint).any(); });
}

/// The share of light at each node that passes specularly from the first lobe to the second.
ArrayXd FacetMeetings::between_nodes(const Meeting& meeting) const {
  const std::vector<Directions>& directions = assembly_.directions();
  const auto cosines = [&](std::size_t gap) -> ArrayXd {
    ArrayXd all = ArrayXd::Zero(directions[gap].nodes);
    all.head(directions[gap].live) = directions[gap].mu.head(directions[gap].live);
    return all;
  };
  return sections_.section(meeting.section, cosines).*meeting.between;
}

double FacetMeetings::cosine(std::size_t boundary, Face face, Index target) const {
  const Directions& here = assembly_.directions()[gap(boundary, face)];
  return here.mu[here.live + target];
}

/// The factors of light that leaves a face of a boundary: at the nodes of the medium there, or at the targets.
VectorXd FacetMeetings::view_weights(std::size_t boundary, Face face, bool at_targets) const {
  const Directions& here = assembly_.directions()[gap(boundary, face)];
  const RoughSurface& surface = *boundaries_[boundary].surface;
  VectorXd weights = VectorXd::Ones(at_targets ? here.targets : here.nodes);
  const Index first = at_targets ? here.live : 0;
  for (Index k = 0; k < (at_targets ? here.targets : here.live); ++k) {
    weights[k] = surface.view_weight(here.mu[first + k]);
  }
  return weights;
}

/// Light that one order of a boundary's lobes sends from targets on one face to nodes on another: [node, target].
MatrixXd FacetMeetings::to_nodes(std::size_t boundary, Face from, Face to, int order) const {
  const Directions& any = assembly_.directions().front();
  const MatrixXd& live = assembly_.surface(boundary).from_targets(from, to, order);
  MatrixXd all = MatrixXd::Zero(any.nodes, any.targets);
  all.topRows(live.rows()) = live;
  return all;
}

void FacetMeetings::take_from(ScatteringFunction& rest, int order) const {
  const Index targets = assembly_.directions().front().targets;
  for (const Meeting& meeting : meetings_) {
    const VectorXd between = between_nodes(meeting).matrix();
    const std::size_t first = assembly_.solution().boundaries()[meeting.first].layer;
    const std::size_t second = assembly_.solution().boundaries()[meeting.second].layer;
    for (const Face entering : kFaces) {
      for (const Face exiting : kFaces) {
        const auto take = [&](DirectionOperator& part, const DeltaField::Arrival& in, const DeltaField::Arrival& out) {
          const VectorXd arrives = at_face(in, entering).tail(targets);
          const VectorXd leaves =
              at_face(out, exiting).tail(targets).cwiseProduct(view_weights(meeting.second, exiting, true));
          if (arrives.isZero(0.0) || leaves.isZero(0.0)) {
            return;
          }
          part.kernel.bottomRightCorner(targets, targets) -=
              leaves.asDiagonal() * to_nodes(meeting.second, exiting, meeting.arriving, order).transpose() *
              between.cwiseProduct(view_weights(meeting.first, meeting.leaving, false)).asDiagonal() *
              to_nodes(meeting.first, entering, meeting.leaving, order) * arrives.asDiagonal();
        };
        if (!exists(meeting.first, entering) || !exists(meeting.second, exiting)) {
          continue;
        }
        const DeltaField& deltas = assembly_.deltas();
        take(rest.reflect_above, deltas.from_above[first], deltas.from_above[second]);
        if (assembly_.solution().stack().base.kind == Base::Kind::kNone) {
          take(rest.reflect_below, deltas.from_below[first], deltas.from_below[second]);
          take(rest.transmit, deltas.from_above[first], deltas.from_below[second]);
        }
      }
    }
  }
}

FacetMeetings::Lobe FacetMeetings::made_lobe(std::size_t boundary, Face from, Face to, double mu) const {
  Rays reflected;
  Rays transmitted;
  boundaries_[boundary].rays[from == Face::kTop ? 0 : 1].scatter(mu, reflected, transmitted);
  const Rays& rays = from == to ? reflected : transmitted;
  const auto array = [](const std::vector<double>& list) {
    return Eigen::Map<const ArrayXd>(list.data(), static_cast<Index>(list.size()));
  };
  Lobe lobe{array(rays.mu), array(rays.azimuth), array(rays.share), ArrayXd(), 0.0};
  lobe.whole = lobe.share.sum();
  if (lobe.whole > 0.0) {
    lobe.density = boundaries_[boundary].surface->values(from, to, mu, {lobe.mu, lobe.azimuth}).col(0) / lobe.whole;
  }
  return lobe;
}

std::shared_ptr<const FacetMeetings::Lobe> FacetMeetings::lobe(std::size_t boundary, Face from, Face to,
                                                               double mu) const {
  constexpr std::size_t kMostRays = 1000000;  // 32 megabytes
  const LobeKey key{boundary, from, to, mu};
  {
    const std::scoped_lock guard(lobes_->lock);
    const auto place = lobes_->known.find(key);
    if (place != lobes_->known.end()) {
      return place->second;
    }
  }
  const auto made = std::make_shared<const Lobe>(made_lobe(boundary, from, to, mu));
  const std::scoped_lock guard(lobes_->lock);
  if (lobes_->rays > kMostRays) {
    lobes_->known.clear();
    lobes_->rays = 0;
  }
  if (lobes_->known.try_emplace(key, made).second) {
    lobes_->rays += static_cast<std::size_t>(made->mu.size());
  }
  return made;
}

/// Adds the rays of the first lobe, weighted with the second lobe's value for a direction of cosine `mu` on `face`.
/// With `backwards`, adds the rays of the second lobe, weighted with the first lobe's value.
void FacetMeetings::add_rays(ArrayXd& sum, const Meeting& meeting, bool backwards, const Lobe& own, const Lobe& other,
                             Face face, double mu, const ArrayXd& dphi) const {
  const std::vector<Directions>& directions = assembly_.directions();
  const std::size_t begin =
      gap(backwards ? meeting.second : meeting.first, backwards ? meeting.arriving : meeting.leaving);
  const std::size_t other_boundary = backwards ? meeting.first : meeting.second;
  const Face other_face = backwards ? meeting.leaving : meeting.arriving;
  const std::size_t end = gap(other_boundary, other_face);
  const auto in_gap = [&](std::size_t gap) -> ArrayXd {
    return own.mu.unaryExpr([&](double m) { return refracted_cosine(m, directions[begin].ior, directions[gap].ior); });
  };
  const ArrayXd arriving = in_gap(end);
  const RoughSurface& first_surface = *boundaries_[meeting.first].surface;
  const ArrayXd& leaving = backwards ? arriving : own.mu;
  const ArrayXd strength = own.share * (sections_.section(meeting.section, in_gap).*meeting.between) *
                           leaving.unaryExpr([&](double m) { return first_surface.view_weight(m); });
  std::vector<Index> live;
  for (Index k = 0; k < strength.size(); ++k) {
    if (strength[k] > 0.0 && arriving[k] > 0.0 && own.density[k] > 0.0) {
      live.push_back(k);
    }
  }
  const Index azimuths = dphi.size();
  const ArrayXd cosine = dphi.cos();
  const ArrayXd sine = dphi.sin();
  constexpr std::size_t kChunk = 512;  // arrays of a chunk stay in the cache
  for (std::size_t first = 0; first < live.size(); first += kChunk) {
    const std::vector<Index> rays(live.begin() + static_cast<std::ptrdiff_t>(first),
                                  live.begin() + static_cast<std::ptrdiff_t>(std::min(first + kChunk, live.size())));
    // Each ray also represents its mirror image in the plane of incidence.
    const ArrayXd along = own.azimuth(rays);
    const ArrayXd across = (1.0 - along.square()).max(0.0).sqrt();
    FacetPairs pairs{arriving(rays), Eigen::ArrayXXd(along.size(), 2 * azimuths)};
    for (Index p = 0; p < azimuths; ++p) {
      pairs.cosines.col(p) = cosine[p] * along + sine[p] * across;
      pairs.cosines.col(azimuths + p) = cosine[p] * along - sine[p] * across;
    }
    const Eigen::ArrayXXd met = boundaries_[other_boundary].surface->values(face, other_face, mu, pairs);
    const ArrayXd density = own.density(rays);
    const ArrayXd half = 0.5 * strength(rays) * density;
    for (Index p = 0; p < 2 * azimuths; ++p) {
      sum[p % azimuths] += (half * met.col(p) / (density + met.col(p) / other.whole)).sum();
    }
  }
}

ArrayXd FacetMeetings::value(Side side, Path path, Index o, Index i, const ArrayXd& dphi) const {
  ArrayXd sum = ArrayXd::Zero(dphi.size());
  const bool leaves_above = (side == Side::kTop) == (path == Path::kReflect);
  const DeltaField& deltas = assembly_.deltas();
  const Index nodes = assembly_.directions().front().nodes;
  for (const Meeting& meeting : meetings_) {
    const std::size_t first = assembly_.solution().boundaries()[meeting.first].layer;
    const std::size_t second = assembly_.solution().boundaries()[meeting.second].layer;
    const auto& in = side == Side::kTop ? deltas.from_above[first] : deltas.from_below[first];
    const auto& out = leaves_above ? deltas.from_above[second] : deltas.from_below[second];
    for (const Face entering : kFaces) {
      for (const Face exiting : kFaces) {
        const double share = at_face(in, entering)[nodes + i] * at_face(out, exiting)[nodes + o];
        if (!(share > 0.0) || !exists(meeting.first, entering) || !exists(meeting.second, exiting)) {
          continue;
        }
        const double mu_i = cosine(meeting.first, entering, i);
        const double mu_o = cosine(meeting.second, exiting, o);
        const std::shared_ptr<const Lobe> forth = lobe(meeting.first, entering, meeting.leaving, mu_i);
        const std::shared_ptr<const Lobe> back = lobe(meeting.second, exiting, meeting.arriving, mu_o);
        if (!(forth->whole > 0.0 && back->whole > 0.0)) {
          continue;
        }
        ArrayXd found = ArrayXd::Zero(dphi.size());
        add_rays(found, meeting, false, *forth, *back, exiting, mu_o, dphi);
        add_rays(found, meeting, true, *back, *forth, entering, mu_i, dphi);
        sum += share * boundaries_[meeting.second].surface->view_weight(mu_o) * found;
      }
    }
  }
  return sum;
}

}  // namespace lamina
