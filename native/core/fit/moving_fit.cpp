// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/moving_fit.hpp"

#include "numeric/nnls.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStep = 1e-3;  // of a difference quotient
constexpr double kFixed = 1e3;  // stiffness of an unknown that stays
constexpr int kMostLobes = 3;
constexpr double kBetweenRows = 0.8;  // of the penalty, relative to that of the first row
constexpr int kSweeps = 3;
constexpr int kStartIterations = 30;
constexpr std::size_t kStarts = 4;  // sets of starts that are tried
// Weight of the squared relative error of the albedo against the squared relative L2 error.
constexpr double kAlbedoWeight = 10.0;

// All residuals are sums of a few columns over the light: closures, lobes, and the slices. Their products give the fit.
class ViewFit {
 public:
  ViewFit(const ViewSlices& view, const LightDirections& light, const VectorXd& solid_angle,
          const MovingFitOptions& options)
      : view_(view),
        light_(light),
        options_(options),
        broad_(view.broad.cols()),
        channels_(view.slices.cols()),
        fixed_(broad_ + channels_ + 1),
        root_(solid_angle.cwiseSqrt()) {
    columns_.resize(root_.size(), fixed_);
    columns_ << root_.asDiagonal() * view.broad, root_.asDiagonal() * view.slices, root_;
    for (Index c = broad_; c < broad_ + channels_; ++c)
      if (const double norm = columns_.col(c).norm(); norm > 0.0) columns_.col(c) /= norm;
    multiply(0);
  }

  // Minimises the residual and the distance to `prior`, from `p` on. `stiffness`: for each unknown.
  VectorXd minimise(VectorXd p, const VectorXd& prior, const VectorXd& stiffness, int iterations,
                    const VectorXd* centre) {
    const Index unknowns = options_.family->unknowns();
    const Index lobes = options_.lobes;
    std::vector<Index> closures(static_cast<std::size_t>(broad_ + lobes));
    std::iota(closures.begin(), closures.begin() + broad_, 0);
    std::iota(closures.begin() + broad_, closures.end(), fixed_);
    const VectorXd stiff2 = stiffness.cwiseAbs2();
    const auto reached = [&](const MatrixXd& left, const VectorXd& at) {
      return squared(left) + stiff2.dot((at - prior).cwiseAbs2());
    };
    clamp(p, centre);
    MatrixXd left = left_by(p, closures);
    double objective = reached(left, p);
    double damping = 1e-2;
    for (int pass = 0; pass < iterations; ++pass) {
      // Difference quotients, with a column for each changed lobe
      const Index first = fixed_ + lobes;
      columns_.conservativeResize(Eigen::NoChange, first + p.size());
      VectorXd steps(p.size());
      for (Index k = 0; k < p.size(); ++k) {
        VectorXd q = p;
        q[k] += q[k] > 0.0 ? -kStep : kStep;
        steps[k] = q[k] - p[k];
        show(q.data() + k / unknowns * unknowns, first + k);
      }
      multiply(first);
      left.conservativeResizeLike(MatrixXd::Zero(columns_.cols(), channels_));
      std::vector<MatrixXd> slopes(static_cast<std::size_t>(channels_), MatrixXd(columns_.cols(), p.size()));
      for (Index k = 0; k < p.size(); ++k) {
        std::vector<Index> changed = closures;
        changed[static_cast<std::size_t>(broad_ + k / unknowns)] = first + k;
        const MatrixXd slope = (left_by(changed) - left) / steps[k];
        for (Index c = 0; c < channels_; ++c) slopes[static_cast<std::size_t>(c)].col(k) = slope.col(c);
      }
      MatrixXd normal = stiff2.asDiagonal();
      VectorXd down = stiff2.cwiseProduct(p - prior);
      for (Index c = 0; c < channels_; ++c) {
        const MatrixXd weighted = slopes[static_cast<std::size_t>(c)].transpose() * products(c);
        normal += weighted * slopes[static_cast<std::size_t>(c)];
        down += weighted * left.col(c);
      }
      columns_.conservativeResize(Eigen::NoChange, first);
      const double before = objective;
      for (int trial = 0; trial < 5; ++trial) {
        MatrixXd damped = normal;
        damped.diagonal() += damping * (normal.diagonal().array() + 1e-6).matrix();
        VectorXd q = p - damped.ldlt().solve(down).cwiseMin(1.0).cwiseMax(-1.0);
        clamp(q, centre);
        left = left_by(q, closures);
        if (const double next = reached(left, q); next < objective) {
          p = q;
          objective = next;
          damping = std::max(damping * 0.2, 1e-6);
          break;
        }
        damping *= 6.0;
      }
      if (!(objective < before * (1.0 - 1e-3))) break;
    }
    reached_ = objective;
    return p;
  }

  // The objective that `minimise` reached.
  [[nodiscard]] double reached() const { return reached_; }

  // The best of all sets on a ladder of lobes, best first, as unknowns. `gain`: by how much the first lowers the
  // squared residual of the broad closures alone.
  std::vector<VectorXd> starts(double& gain) {
    const std::vector<VectorXd> ladder = options_.family->starts(options_.retro);
    const Index size = options_.family->unknowns();
    columns_.conservativeResize(Eigen::NoChange, fixed_ + static_cast<Index>(ladder.size()));
    for (std::size_t k = 0; k < ladder.size(); ++k) show(ladder[k].data(), fixed_ + static_cast<Index>(k));
    multiply(fixed_);
    std::vector<Index> closures(static_cast<std::size_t>(broad_));
    std::iota(closures.begin(), closures.end(), 0);
    gain = squared(left_by(closures));
    closures.resize(closures.size() + static_cast<std::size_t>(options_.lobes));
    std::vector<std::size_t> rung(static_cast<std::size_t>(options_.lobes));
    std::iota(rung.begin(), rung.end(), 0);
    std::vector<std::pair<double, VectorXd>> found;
    for (bool is_last = false; !is_last;) {
      VectorXd p(options_.lobes * size);
      for (std::size_t k = 0; k < rung.size(); ++k) {
        p.segment(static_cast<Index>(k) * size, size) = ladder[rung[k]];
        closures[static_cast<std::size_t>(broad_) + k] = fixed_ + static_cast<Index>(rung[k]);
      }
      found.emplace_back(squared(left_by(closures)), p);
      is_last = !next(rung, ladder.size());
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    gain -= found.front().first;
    found.resize(std::min<std::size_t>(found.size(), kStarts));
    std::vector<VectorXd> best;
    for (auto& [reached, p] : found) best.push_back(std::move(p));
    return best;
  }

 private:
  // Makes a column that of a lobe.
  void show(const double* p, Index column) {
    options_.family->values(p, view_.mu_o, view_.phi_o, light_, columns_.col(column));
    columns_.col(column).array() *= root_.array();
  }

  // Products of columns, up to date for those before `first`.
  void multiply(Index first) {
    const Index count = columns_.cols();
    products_.conservativeResize(count, count);
    products_.rightCols(count - first).noalias() = columns_.transpose() * columns_.rightCols(count - first);
    products_.bottomLeftCorner(count - first, first) = products_.topRightCorner(first, count - first).transpose();
  }

  // With the products of albedos.
  [[nodiscard]] MatrixXd products(Index c) const {
    const auto albedo = products_.col(fixed_ - 1);
    const double own = albedo[broad_ + c];
    const double weight = own > 0.0 ? kAlbedoWeight / (own * own) : 0.0;
    return products_ + weight * albedo * albedo.transpose();
  }

  // What the best weights of some columns leave of each channel's slice, relative to the slice, as a sum of columns:
  // [column, channel].
  [[nodiscard]] MatrixXd left_by(const std::vector<Index>& closures) const {
    MatrixXd left = MatrixXd::Zero(columns_.cols(), channels_);
    for (Index c = 0; c < channels_; ++c) {
      const MatrixXd every = products(c);
      SmallMatrix gram = every(closures, closures);
      const SmallVector scale = gram.diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
      gram = scale.asDiagonal() * gram * scale.asDiagonal();
      const SmallVector right = every.col(broad_ + c)(closures).cwiseProduct(scale);
      SmallVector x = SmallVector::Zero(right.size());
      ActiveSet(gram, right).solve(x);
      left(broad_ + c, c) = 1.0;
      left.col(c)(closures) = -x.cwiseProduct(scale);
    }
    return left;
  }
  [[nodiscard]] MatrixXd left_by(const VectorXd& p, const std::vector<Index>& closures) {
    columns_.conservativeResize(Eigen::NoChange, fixed_ + options_.lobes);
    for (Index k = 0; k < options_.lobes; ++k) show(p.data() + k * options_.family->unknowns(), fixed_ + k);
    multiply(fixed_);
    return left_by(closures);
  }

  [[nodiscard]] double squared(const MatrixXd& left) const {
    double sum = 0.0;
    for (Index c = 0; c < channels_; ++c) sum += left.col(c).dot(products(c) * left.col(c));
    return sum;
  }

  // The next set of ascending rungs of the ladder; false after the last one.
  static bool next(std::vector<std::size_t>& rung, std::size_t rungs) {
    const std::size_t count = rung.size();
    for (std::size_t k = count; k-- > 0;) {
      if (rung[k] == rungs - count + k) continue;
      ++rung[k];
      for (std::size_t j = k + 1; j < count; ++j) rung[j] = rung[j - 1] + 1;
      return true;
    }
    return false;
  }

  void clamp(VectorXd& p, const VectorXd* centre) const {
    const double most = options_.most_change;
    if (centre != nullptr)
      p = p.cwiseMax((centre->array() - most).matrix()).cwiseMin((centre->array() + most).matrix());
    for (int k = 0; k < options_.lobes; ++k)
      options_.family->clamp(p.data() + k * options_.family->unknowns(), view_.mu_o);
  }

  const ViewSlices& view_;
  const LightDirections& light_;
  const MovingFitOptions& options_;
  Index broad_;
  Index channels_;
  Index fixed_;  // columns before those of lobes
  VectorXd root_;
  MatrixXd columns_;  // broad closures, slices of norm 1, ones and lobes, times the root of the solid angle
  MatrixXd products_;
  double reached_ = 0.0;
};

struct RowFit {
  std::vector<VectorXd> unknowns;  // of each view
  double objective = 0.0;          // sum over the views
};

void one_by_one(std::size_t count, const std::function<void(std::size_t)>& body) {
  for (std::size_t k = 0; k < count; ++k) body(k);
}

// The penalty's stiffness for each unknown of all lobes. Odd unknowns stay 0 where the slices are symmetric, so that
// the lobes of a row and of its mirror image meet.
VectorXd stiffness_at(const ViewSlices& view, const MovingFitOptions& options, double usual) {
  const Index unknowns = options.family->unknowns();
  VectorXd stiffness = VectorXd::Constant(options.lobes * unknowns, usual);
  for (Index lobe = 0; view.is_mirrored && lobe < options.lobes; ++lobe)
    for (const Index odd : options.family->odd()) stiffness[lobe * unknowns + odd] = kFixed;
  return stiffness;
}

// Unknowns of a neighbouring row, as the fit of this view begins with them.
VectorXd started(const ViewSlices& view, const MovingFitOptions& options, VectorXd p) {
  for (Index lobe = 0; view.is_mirrored && lobe < options.lobes; ++lobe)
    for (const Index odd : options.family->odd()) p[lobe * options.family->unknowns() + odd] = 0.0;
  return p;
}

// The views of one row. `neighbours`: shapes of the neighbouring row, or those of the view `first` alone.
RowFit fit_row(std::span<const ViewSlices> views, const LightDirections& light, const VectorXd& solid_angle,
               const MovingFitOptions& options, std::span<const VectorXd> neighbours, std::size_t first,
               const ForEach& for_each) {
  const Index unknowns = options.family->unknowns();
  const Index tilts = options.family->tilts();
  const bool follows_row = neighbours.size() == views.size();
  std::vector<VectorXd> start;
  for (const VectorXd& p : neighbours) start.push_back(started(views[start.size()], options, p));
  std::vector<VectorXd> found(views.size());
  const auto fit_view = [&](std::size_t v, const VectorXd& prior) {
    VectorXd stiff = stiffness_at(views[v], options, options.stiffness * (follows_row ? kBetweenRows : 1.0));
    VectorXd from = prior;
    for (int k = 0; v == 0 && k < options.lobes; ++k) {  // at the normal, where a tilt has no effect
      stiff.segment((k + 1) * unknowns - tilts, tilts).setConstant(kFixed);
      if (!options.family->is_round_at_normal()) continue;
      from[k * unknowns + 1] = 0.0;
      stiff[k * unknowns + 1] = kFixed;
    }
    found[v] = ViewFit(views[v], light, solid_angle, options)
                   .minimise(from, from, stiff, options.iterations, follows_row ? &from : nullptr);
  };
  if (follows_row) {
    for_each(views.size(), [&](std::size_t v) { fit_view(v, start[v]); });
  } else {
    found[first] = start[0];
    for (std::size_t v = first + 1; v < views.size(); ++v) fit_view(v, found[v - 1]);
    for (std::size_t v = first; v-- > 0;) fit_view(v, found[v + 1]);
  }

  // Towards the mean of the neighbours
  const double usual = options.stiffness * (follows_row ? options.following : 1.0);
  std::vector<VectorXd> smooth = found;
  VectorXd objective = VectorXd::Zero(static_cast<Index>(views.size()));
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    found = smooth;
    for_each(views.size() - 1, [&](std::size_t k) {
      const std::size_t v = k + 1;
      const VectorXd prior = v + 1 < views.size() ? VectorXd(0.5 * (found[v - 1] + found[v + 1])) : found[v - 1];
      const VectorXd stiff = stiffness_at(views[v], options, usual);
      ViewFit fit(views[v], light, solid_angle, options);
      smooth[v] = fit.minimise(found[v], prior, stiff, options.iterations / 2, follows_row ? &start[v] : nullptr);
      double least = fit.reached();
      // A neighbour may have found a lower minimum
      for (const std::size_t other : {v - 1, v + 1}) {
        if (follows_row || other >= views.size()) continue;
        const VectorXd theirs = fit.minimise(found[other], prior, stiff, options.iterations, nullptr);
        if (fit.reached() < least) {
          least = fit.reached();
          smooth[v] = theirs;
        }
      }
      objective[static_cast<Index>(v)] = least;
    });
  }
  // At the normal, tilts continue those of the next view
  for (int k = 0; k < options.lobes && views.size() > 1; ++k)
    smooth[0].segment((k + 1) * unknowns - tilts, tilts) = smooth[1].segment((k + 1) * unknowns - tilts, tilts);
  return {smooth, objective.sum()};
}

// The unknowns of the row `first`, the best of several starts at the oblique view. This is the last symmetric row, if
// there is any, or the row that lobes improve most.
std::vector<VectorXd> fit_best_row(std::span<const std::vector<ViewSlices>> rows, const LightDirections& light,
                                   const VectorXd& solid_angle, const MovingFitOptions& options, std::size_t oblique,
                                   const ForEach& for_each, std::size_t& first) {
  std::vector<std::vector<VectorXd>> starts(rows.size());
  VectorXd gain(static_cast<Index>(rows.size()));
  for_each(rows.size(), [&](std::size_t row) {
    ViewFit fit(rows[row][oblique], light, solid_angle, options);
    starts[row] = fit.starts(gain[static_cast<Index>(row)]);
  });
  Index best = 0;
  gain.maxCoeff(&best);
  // Symmetric lobes can't be reached from others by small changes
  for (std::size_t row = 0; row < rows.size(); ++row)
    if (rows[row].front().is_mirrored) best = static_cast<Index>(row);
  first = static_cast<std::size_t>(best);
  std::vector<RowFit> tried(starts[first].size());
  for_each(tried.size(), [&](std::size_t k) {
    ViewFit view(rows[first][oblique], light, solid_angle, options);
    const VectorXd free = stiffness_at(rows[first][oblique], options, 0.0);
    const VectorXd start = view.minimise(starts[first][k], starts[first][k], free, kStartIterations, nullptr);
    tried[k] = fit_row(rows[first], light, solid_angle, options, std::span(&start, 1), oblique, one_by_one);
  });
  const auto less = [](const RowFit& a, const RowFit& b) { return a.objective < b.objective; };
  return std::move(std::min_element(tried.begin(), tried.end(), less)->unknowns);
}

}  // namespace

std::vector<std::vector<LobeShapes>> fit_moving_lobes(std::span<const std::vector<ViewSlices>> rows,
                                                      const LightDirections& light, const VectorXd& solid_angle,
                                                      const MovingFitOptions& options, const ForEach& for_each,
                                                      std::span<const LobeShapes> first_row) {
  if (options.lobes < 1 || options.lobes > kMostLobes || rows.empty())
    throw std::invalid_argument("fit_moving_lobes: number of lobes or rows out of range");
  const std::size_t oblique = rows.front().size() * 2 / 3;
  const Index unknowns = options.family->unknowns();
  std::vector<std::vector<VectorXd>> found(rows.size());
  const auto fit = [&](std::size_t row, std::span<const VectorXd> start) {
    found[row] = fit_row(rows[row], light, solid_angle, options, start, oblique, for_each).unknowns;
  };
  std::size_t first = 0;
  if (first_row.empty()) {
    std::vector<VectorXd> best = fit_best_row(rows, light, solid_angle, options, oblique, for_each, first);
    found[first] = std::move(best);
  } else {
    for (const LobeShapes& view : first_row) {
      VectorXd& p = found[0].emplace_back(options.lobes * unknowns);
      for (int k = 0; k < options.lobes; ++k)
        p.segment(k * unknowns, unknowns) = options.family->unknowns_of(view.data() + k * unknowns);
    }
  }
  for (std::size_t row = first + 1; row < rows.size(); ++row) fit(row, found[row - 1]);
  for (std::size_t row = first; row-- > 0;) fit(row, found[row + 1]);

  std::vector<std::vector<LobeShapes>> shapes(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (const VectorXd& p : found[row]) {
      LobeShapes& view = shapes[row].emplace_back(options.lobes * unknowns);
      for (int k = 0; k < options.lobes; ++k)
        view.segment(k * unknowns, unknowns) = options.family->shape(p.data() + k * unknowns);
    }
  return shapes;
}

}  // namespace lamina
