// SPDX-License-Identifier: GPL-3.0-or-later
#include "operators/directions.hpp"

#include <algorithm>
#include <cmath>

namespace lamina {

double refracted_cosine(double mu, double from_ior, double to_ior) {
  if (from_ior == to_ior) {
    return mu;
  }
  const double ratio = from_ior / to_ior;
  return std::sqrt(std::max(0.0, 1.0 - ratio * ratio * (1.0 - mu * mu)));
}

Eigen::MatrixXd Directions::spread(const Eigen::MatrixXd& compact) const {
  if (live == nodes) {
    return compact;
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size(), size());
  all.topLeftCorner(live, live) = compact.topLeftCorner(live, live);
  all.topRightCorner(live, targets) = compact.topRightCorner(live, targets);
  all.bottomLeftCorner(targets, size()).leftCols(live) = compact.bottomLeftCorner(targets, live);
  all.bottomRightCorner(targets, targets) = compact.bottomRightCorner(targets, targets);
  return all;
}

Eigen::VectorXd Directions::spread(const Eigen::VectorXd& compact) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size());
  all.head(live) = compact.head(live);
  all.tail(targets) = compact.tail(targets);
  return all;
}

namespace {

/// The points that divide a range of cosines up to `end` for a layer of thickness `thinnest`, ascending.
std::vector<double> divisions(double end, double thinnest) {
  constexpr double kResolved = 0.05;  // 32 nodes on (0, 1) resolve layers of this thickness
  constexpr double kStep = 20.0;      // ratio of successive ends
  std::vector<double> ends{end};
  if (thinnest < kResolved) {
    for (double next = end / 8.0; next > thinnest; next /= kStep) {
      ends.insert(ends.begin(), next);
    }
  }
  return ends;
}

}  // namespace

DirectionSet::DirectionSet(std::vector<double> indices, int count, const std::map<double, double>& thinnest) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  constexpr int kFewest = 8;    // least number of nodes beyond a critical angle
  constexpr int kGrazing = 14;  // nodes of each further range towards grazing
  for (std::size_t k = 0; k < indices.size(); ++k) {
    // The range extends from grazing incidence to the critical angle with the next less dense medium.
    const double critical = k == 0 ? 1.0 : refracted_cosine(0.0, indices[k - 1], indices[k]);
    double low = 0.0;
    // Directions that are grazing in this medium are grazing in no other.
    const auto thin = thinnest.find(indices[k]);
    for (const double high : divisions(critical, thin == thinnest.end() ? 1.0 : thin->second)) {
      const int most = k == 0 ? count : std::max(kFewest, static_cast<int>(std::ceil(critical * count)));
      ranges_.push_back({indices[k], Quadrature(high == critical ? most : kGrazing, low, high)});
      low = high;
    }
  }
}

DirectionSet DirectionSet::finer_by(double factor) const {
  DirectionSet fine = *this;
  for (Range& range : fine.ranges_) {
    const int more = static_cast<int>(std::ceil(factor * static_cast<double>(range.nodes.mu.size())));
    range.nodes = Quadrature(more, range.nodes.low(), range.nodes.high());
  }
  return fine;
}

DirectionSet DirectionSet::divided(double division, int nodes) const {
  DirectionSet fine = *this;
  const auto steepest = std::find_if(fine.ranges_.begin(), fine.ranges_.end(),
                                     [&](const Range& range) { return range.nodes.high() > division; });
  const Range range = *steepest;
  *steepest = {range.ior, Quadrature(static_cast<int>(range.nodes.mu.size()), range.nodes.low(), division)};
  fine.ranges_.insert(steepest + 1, {range.ior, Quadrature(nodes, division, range.nodes.high())});
  return fine;
}

Eigen::MatrixXd DirectionSet::carry_to(const DirectionSet& fine) const {
  Eigen::Index rows = 0;
  Eigen::Index columns = 0;
  for (std::size_t k = 0; k < ranges_.size(); ++k) {
    rows += fine.ranges_[k].nodes.mu.size();
    columns += ranges_[k].nodes.mu.size();
  }
  Eigen::MatrixXd carry = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::Index row = 0;
  Eigen::Index column = 0;
  for (std::size_t k = 0; k < ranges_.size(); ++k) {
    const Quadrature& to = fine.ranges_[k].nodes;
    const Quadrature& from = ranges_[k].nodes;
    const Eigen::VectorXd scale = (from.mu.array() * from.weight.array()).sqrt();
    for (Eigen::Index i = 0; i < to.mu.size(); ++i) {
      carry.row(row + i).segment(column, from.mu.size()) =
          std::sqrt(to.mu[i] * to.weight[i]) * from.interpolate(to.mu[i]).cwiseQuotient(scale.transpose());
    }
    row += to.mu.size();
    column += from.mu.size();
  }
  return carry;
}

/// The range that contains a cosine in air, and the index of its first node.
const DirectionSet::Range& DirectionSet::range_of(double mu_in_air, Eigen::Index& first) const {
  first = 0;
  for (const Range& range : ranges_) {
    if (mu_in_air <= range.nodes.high()) {
      return range;
    }
    first += range.nodes.mu.size();
  }
  return ranges_.front();
}

Directions DirectionSet::in_medium(double ior, const Eigen::VectorXd& targets_in_air) const {
  Directions d;
  d.ior = ior;
  d.targets = targets_in_air.size();
  for (const Range& range : ranges_) {
    d.nodes += range.nodes.mu.size();
    d.live += range.ior <= ior ? range.nodes.mu.size() : 0;
  }
  const Eigen::Index compact = d.live + d.targets;
  d.mu.resize(compact);
  d.weight.resize(d.live);
  d.scale.resize(compact);
  d.interpolation = Eigen::MatrixXd::Zero(compact, d.live);
  d.interpolation.topRows(d.live).setIdentity();
  Eigen::Index node = 0;
  for (const Range& range : ranges_) {
    if (range.ior > ior) {
      break;
    }
    for (Eigen::Index i = 0; i < range.nodes.mu.size(); ++i, ++node) {
      const double own = range.nodes.mu[i];
      d.mu[node] = refracted_cosine(own, range.ior, ior);
      // n^2 mu dmu is the same in all media.
      const double ratio = range.ior / ior;
      d.weight[node] = range.nodes.weight[i] * ratio * ratio * own / d.mu[node];
      d.scale[node] = std::sqrt(2.0 * d.mu[node] * d.weight[node]);
    }
  }
  for (Eigen::Index t = 0; t < d.targets; ++t) {
    d.mu[d.live + t] = refracted_cosine(targets_in_air[t], 1.0, ior);
    d.scale[d.live + t] = 1.0 / ior;
    Eigen::Index first = 0;
    const Range& range = range_of(targets_in_air[t], first);
    d.interpolation.row(d.live + t).segment(first, range.nodes.mu.size()) = range.nodes.interpolate(targets_in_air[t]);
  }
  return d;
}

std::vector<double> DirectionSet::ends(double ior) const {
  std::vector<double> cosines{0.0};
  for (const Range& range : ranges_) {
    const double cosine = refracted_cosine(range.nodes.high(), range.ior, ior);
    // The end of a range in a denser medium is the beginning of the next range, of a less dense medium.
    if (range.ior <= ior && cosine > 0.0 && cosine < 1.0) {
      cosines.push_back(cosine);
    }
  }
  return cosines;
}

double DirectionSet::moment_error() const {
  double worst = 0.0;
  for (const Range& range : ranges_) {
    worst = std::max(worst, range.nodes.moment_error());
  }
  return worst;
}

}  // namespace lamina
