// SPDX-License-Identifier: GPL-3.0-or-later
#include "slice_evaluation.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "view_light_kernels.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using std::numbers::pi;

/// One solution's share of the work: filled order by order, then read view by view.
class Work {
 public:
  Work(const Solution& solution, std::span<const Sight> sights, const SliceGrid& grid)
      : solution_(solution),
        sights_(sights),
        grid_(grid),
        geometry_(solution, grid.view_mu, grid.light_mu),
        coefficients_(sights.size(), Eigen::MatrixXd(grid.view_mu.size() * grid.light_mu.size(), solution.orders())),
        waves_(solution.orders(), grid.dphi.size()) {
    for (Index m = 0; m < waves_.rows(); ++m) {
      waves_.row(m) = (m == 0 ? 1.0 : 2.0) / pi * (static_cast<double>(m) * grid.dphi.array()).cos();
    }
  }

  /// Joins an order and keeps what the sights need of it.
  void solve_order(int order) {
    ViewLightOrder solved(solution_, geometry_, order);
    for (std::size_t k = 0; k < sights_.size(); ++k) {
      const bool top = sights_[k].viewer == Side::kTop;
      const Eigen::MatrixXd& seen = sights_[k].path == Path::kReflect ? (top ? solved.above : solved.below)
                                                                      : (top ? solved.upward : solved.downward);
      // Lights fastest: a view's coefficients are rows that follow each other.
      Eigen::Map<Eigen::MatrixXd>(coefficients_[k].col(order).data(), grid_.light_mu.size(), grid_.view_mu.size()) =
          seen.transpose();
    }
    if (order == 0) {
      zeroth_ = std::make_unique<ScatteringFunction>(std::move(solved.whole));
    }
  }

  /// Albedo and direct light of a sight for each view.
  void write_fluxes(std::size_t sight, double* albedo, double* direct) const {
    const Directions& d = geometry_.directions();
    const Index views = grid_.view_mu.size();
    const bool top = sights_[sight].viewer == Side::kTop;
    // A target's kernel lacks its own scale: sum over nodes of pi f (2 mu w) remains.
    const Eigen::VectorXd sums = d.scale.head(d.nodes);
    Eigen::Map<Eigen::VectorXd> flux(albedo, views);
    Eigen::Map<Eigen::VectorXd> unscattered(direct, views);
    unscattered.setZero();
    if (sights_[sight].path == Path::kReflect) {
      const DirectionOperator& reflect = top ? zeroth_->reflect_above : zeroth_->reflect_below;
      flux = reflect.kernel.block(d.nodes, 0, views, d.nodes) * sums;
      return;
    }
    // By reciprocity, what is seen from a side is what a beam from there sends through.
    flux = top ? (zeroth_->transmit.kernel.block(0, d.nodes, d.nodes, views).transpose() * sums).eval()
               : (zeroth_->transmit.kernel.block(d.nodes, 0, views, d.nodes) * sums).eval();
    if (solution_.stack().base.kind == Base::Kind::kNone) {
      // The direct beam of the true, not the truncated, thickness; the rest counts as scattered.
      double tau = 0.0;
      for (const Layer& layer : solution_.stack().layers) {
        tau += std::get<Medium>(layer).tau;
      }
      unscattered = direct_transmissions(grid_.view_mu, tau);
      flux += zeroth_->transmit.delta.segment(d.nodes, views) - unscattered;
    }
  }

  /// The slice of a view: light scattered once under the true phase function, and the sum of all orders.
  void write_slice(std::size_t sight, Index view, double* values) const {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Index lights = grid_.light_mu.size();
    Eigen::Map<RowMajor> slice(values, lights, grid_.dphi.size());
    slice.noalias() = coefficients_[sight].middleRows(view * lights, lights) * waves_;
    for (std::size_t layer = 0; layer < geometry_.media().size(); ++layer) {
      add_single(sight, view, layer, slice);
    }
    slice = grid_.light_mu.asDiagonal() * slice;
  }

 private:
  template <typename Slice>
  void add_single(std::size_t sight, Index view, std::size_t layer, Slice& slice) const {
    const Directions& d = geometry_.directions();
    const ViewLightGeometry::Medium& medium = geometry_.media()[layer];
    const bool reflects = sights_[sight].path == Path::kReflect;
    const bool from_top = (sights_[sight].viewer == Side::kTop) == reflects;
    const Eigen::VectorXd& out = sights_[sight].viewer == Side::kTop ? medium.above : medium.below;
    const Eigen::VectorXd& in = from_top ? medium.above : medium.below;
    const double weight =
        0.25 / pi * solution_.scatterers()[layer].medium.single_scattering_albedo() * out[d.nodes + view];
    const Eigen::MatrixXd& shape = reflects ? medium.turned.pairs : medium.passed.pairs;
    const double mu_o = grid_.view_mu[view];
    const Eigen::ArrayXd azimuth = grid_.dphi.array().cos();
    Eigen::ArrayXd phase(azimuth.size());
    for (Index i = 0; i < slice.rows(); ++i) {
      const double mu_i = grid_.light_mu[i];
      const double strength = weight * shape(view, i) * in[d.nodes + d.views + i];
      if (strength == 0.0) {
        continue;
      }
      phase = std::sqrt((1.0 - mu_o * mu_o) * (1.0 - mu_i * mu_i)) * azimuth + (reflects ? -1.0 : 1.0) * mu_o * mu_i;
      solution_.scatterers()[layer].phase.evaluate_all(phase);
      slice.row(i) += strength * phase.matrix().transpose();
    }
  }

  const Solution& solution_;
  std::span<const Sight> sights_;
  const SliceGrid& grid_;
  ViewLightGeometry geometry_;
  std::vector<Eigen::MatrixXd> coefficients_;  // by sight: [view and light, order]
  Eigen::MatrixXd waves_;                      // [order, dphi]
  std::unique_ptr<ScatteringFunction> zeroth_;
};

}  // namespace

void evaluate_slices(std::span<const Solution* const> solutions, std::span<const Sight> sights, const SliceGrid& grid,
                     const SliceSinks& sinks, ThreadPool& pool) {
  for (const Solution* solution : solutions) {
    if (!has_only_media(solution->stack())) {
      throw std::invalid_argument("slices: a stack with a dielectric boundary or a metal base has none yet");
    }
  }
  std::vector<std::unique_ptr<Work>> work(solutions.size());
  pool.run(work.size(), [&](std::size_t k) { work[k] = std::make_unique<Work>(*solutions[k], sights, grid); });

  std::vector<std::pair<std::size_t, int>> tasks;
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    for (int order = 0; order < solutions[k]->orders(); ++order) {
      tasks.emplace_back(k, order);
    }
  }
  pool.run(tasks.size(), [&](std::size_t t) { work[tasks[t].first]->solve_order(tasks[t].second); });

  const auto views = static_cast<std::size_t>(grid.view_mu.size());
  const auto lights = static_cast<std::size_t>(grid.lights());
  constexpr std::size_t kChunk = 8;  // views of a task: each is a few microseconds
  const std::size_t chunks = (views + kChunk - 1) / kChunk;
  pool.run(sights.size() * work.size() * chunks, [&](std::size_t t) {
    const std::size_t table = t / chunks;
    const std::size_t sight = table / work.size();
    const std::size_t first = t % chunks * kChunk;
    const Work& mine = *work[table % work.size()];
    if (first == 0) {
      mine.write_fluxes(sight, sinks.albedo + table * views, sinks.direct + table * views);
    }
    for (std::size_t view = first; view < std::min(views, first + kChunk); ++view) {
      mine.write_slice(sight, static_cast<Index>(view), sinks.values + (table * views + view) * lights);
    }
  });
}

}  // namespace lamina
