// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/oriented_evaluation.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>

#include "oriented/beam_set.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using std::numbers::pi;

/// Distinct beams, in the order of their first use.
class BeamList {
 public:
  std::size_t find(const Beam& beam) {
    const auto [entry, added] = places_.try_emplace(beam, beams_.size());
    if (added) {
      beams_.push_back(beam);
    }
    return entry->second;
  }
  const std::vector<Beam>& beams() const { return beams_; }

 private:
  std::map<Beam, std::size_t> places_;
  std::vector<Beam> beams_;
};

/// The columns of some problems; zeros where there are none.
GapLight chosen(const GapLight& light, const std::vector<Index>& columns) {
  const auto of = [&](const Eigen::MatrixXd& all) -> Eigen::MatrixXd {
    if (all.cols() == 0) {
      return Eigen::MatrixXd::Zero(all.rows(), static_cast<Index>(columns.size()));
    }
    return all(Eigen::all, columns);
  };
  GapLight some;
  for (std::size_t block = 0; block < light.up.size(); ++block) {
    some.up.emplace_back();
    some.down.emplace_back();
    for (std::size_t gap = 0; gap < light.up[block].size(); ++gap) {
      some.up[block].push_back(of(light.up[block][gap]));
      some.down[block].push_back(of(light.down[block][gap]));
    }
  }
  return some;
}

/// Light that the layers scatter for the last time into the direction `out`, from the radiance of problem `in`.
double last_scattered(const GapLight& directions, Index out, const GapLight& light, Index in) {
  double sum = 0.0;
  for (std::size_t block = 0; block < light.up.size(); ++block) {
    for (std::size_t gap = 0; gap < light.up[block].size(); ++gap) {
      if (const Eigen::MatrixXd& up = directions.up[block][gap]; up.cols() > 0) {
        sum += up.col(out).dot(light.down[block][gap].col(in));
      }
      if (const Eigen::MatrixXd& down = directions.down[block][gap]; down.cols() > 0) {
        sum += down.col(out).dot(light.up[block][gap].col(in));
      }
    }
  }
  return sum;
}

}  // namespace

std::vector<double> evaluate_oriented(const OrientedSolution& solution, Side side, Path path,
                                      const OrientedPoints& points, ThreadPool& pool) {
  constexpr std::size_t kMostBeams = 192;  // at once, for memory
  const bool from_below = side == Side::kBottom;
  const bool to_below = from_below == (path == Path::kReflect);
  std::vector<double> values(static_cast<std::size_t>(points.mu_o.size()));
  for (std::size_t first = 0; first < values.size();) {
    BeamList list;
    std::vector<std::size_t> out;
    std::vector<std::size_t> in;
    std::size_t last = first;
    for (; last < values.size() && list.beams().size() + 1 < kMostBeams; ++last) {
      const Index k = static_cast<Index>(last);
      out.push_back(list.find({points.mu_o[k], points.phi_o[k], to_below}));
      in.push_back(list.find({points.mu_i[k], points.phi_o[k] - points.dphi[k], from_below}));
    }
    const BeamSet set(solution, list.beams(), pool);
    // By reciprocity, light may be followed from either end: the fewer problems are solved.
    const auto distinct = [&](const std::vector<std::size_t>& ends) {
      std::vector<Index> found(ends.begin(), ends.end());
      std::sort(found.begin(), found.end());
      found.erase(std::unique(found.begin(), found.end()), found.end());
      return found;
    };
    const std::vector<Index> outs = distinct(out);
    const std::vector<Index> ins = distinct(in);
    const bool backwards = outs.size() < ins.size();
    const std::vector<Index>& starts = backwards ? outs : ins;
    const GapLight light = solution.light(chosen(set.scattered(), starts));
    pool.run(out.size(), [&](std::size_t k) {
      const auto start = static_cast<Index>(backwards ? out[k] : in[k]);
      const auto end = static_cast<Index>(backwards ? in[k] : out[k]);
      const Index problem = std::lower_bound(starts.begin(), starts.end(), start) - starts.begin();
      values[first + k] =
          std::max(0.0, set.by_one_layer(out[k], in[k]) + last_scattered(set.scattered(), end, light, problem) / pi);
    });
    first = last;
  }
  return values;
}

GapLight columns(const GapLight& light, Index first, Index size) {
  std::vector<Index> some(static_cast<std::size_t>(size));
  std::iota(some.begin(), some.end(), first);
  return chosen(light, some);
}

VectorXd leaving(const OrientedSolution& solution, const GapLight& light, bool above) {
  const Directions outside = above ? solution.directions(VectorXd()).front() : solution.directions(VectorXd()).back();
  const Eigen::MatrixXd& values = above ? light.up[0].front() : light.down[0].back();
  return values.topRows(outside.live).transpose() * (outside.ior * outside.scale);
}

Fluxes oriented_fluxes(const OrientedSolution& solution, Side side, const VectorXd& mu, const VectorXd& phi,
                       ThreadPool& pool) {
  constexpr Index kMostBeams = 192;
  const bool below = side == Side::kBottom;
  const bool opaque = solution.stack().base.kind != Base::Kind::kNone;
  const Index count = mu.size();
  Fluxes all{VectorXd::Zero(count), VectorXd::Zero(count), VectorXd::Zero(count), VectorXd::Zero(count)};
  for (Index first = 0; first < count; first += kMostBeams) {
    const Index size = std::min(kMostBeams, count - first);
    std::vector<Beam> beams;
    for (Index k = first; k < first + size; ++k) {
      beams.push_back({mu[k], phi[k], below});
    }
    const BeamSet set(solution, beams, pool);
    const GapLight light = solution.light(columns(set.scattered(), 0, size));
    all.reflected.segment(first, size) = leaving(solution, light, !below);
    if (!opaque) {
      all.transmitted.segment(first, size) = leaving(solution, light, below);
    }
  }
  const Deltas specular = specular_light(solution, mu);
  all.mirrored = below ? specular.reflect_below : specular.reflect_above;
  if (!opaque) {
    all.direct = specular.transmit;
  }
  return all;
}

Fluxes oriented_diffuse_fluxes(const OrientedSolution& solution, Side side, ThreadPool& /*pool*/) {
  const bool below = side == Side::kBottom;
  const std::vector<Directions> gaps = solution.directions(VectorXd());
  const Directions& outside = below ? gaps.back() : gaps.front();
  GapLight source = solution.dark(1);
  const VectorXd common = outside.ior * outside.scale;
  (below ? source.up[0].back() : source.down[0].front()).col(0).head(outside.live) = common;
  const GapLight light = solution.light(std::move(source));
  const double whole = common.squaredNorm();
  const Deltas specular = specular_light(solution, outside.mu);
  const Eigen::ArrayXd shares = common.array().square() / whole;
  const auto mean = [&](const Eigen::ArrayXd& part) -> VectorXd {
    return VectorXd::Constant(1, (shares * part).sum());
  };
  Fluxes all{VectorXd::Zero(1), VectorXd::Zero(1), VectorXd::Zero(1), VectorXd::Zero(1)};
  all.mirrored = mean(below ? specular.reflect_below : specular.reflect_above);
  all.reflected = leaving(solution, light, !below) / whole - all.mirrored;
  if (solution.stack().base.kind == Base::Kind::kNone) {
    all.direct = mean(specular.transmit);
    all.transmitted = leaving(solution, light, below) / whole - all.direct;
  }
  return all;
}

}  // namespace lamina
