// SPDX-License-Identifier: GPL-3.0-or-later
#include "table/slice_evaluation.hpp"

#include <algorithm>
#include <memory>
#include <numbers>
#include <vector>

#include "table/assembly_slices.hpp"
#include "table/media_slices.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using std::numbers::pi;

/// The work for one solution: filled order by order, then read view by view.
class Work {
 public:
  Work(const Solution& solution, std::span<const Sight> sights, const SliceGrid& grid, ThreadPool& pool)
      : grid_(grid), sights_(sights) {
    if (has_only_media(solution.stack())) {
      source_ = std::make_unique<MediaSlices>(solution, sights, grid);
    } else {
      source_ = std::make_unique<AssemblySlices>(solution, sights, grid, pool);
    }
    coefficients_.assign(sights.size(), Eigen::MatrixXd(grid.view_mu.size() * grid.light_mu.size(), orders()));
    waves_.resize(orders(), grid.dphi.size());
    for (Index m = 0; m < waves_.rows(); ++m) {
      waves_.row(m) = (m == 0 ? 1.0 : 2.0) / pi * (static_cast<double>(m) * grid.dphi.array()).cos();
    }
  }

  int orders() const { return source_->orders(); }

  void solve_order(int order) {
    const std::vector<Eigen::MatrixXd> seen = source_->order(order);
    for (std::size_t k = 0; k < seen.size(); ++k) {
      // The light varies fastest, so the coefficients of a view are consecutive rows.
      Eigen::Map<Eigen::MatrixXd>(coefficients_[k].col(order).data(), grid_.light_mu.size(), grid_.view_mu.size()) =
          seen[k].transpose();
    }
  }

  void write_shares(std::size_t sight, double* albedo, double* direct) const {
    const SliceSource::Shares shares = source_->shares(sights_[sight]);
    Eigen::Map<Eigen::VectorXd>(albedo, shares.albedo.size()) = shares.albedo;
    Eigen::Map<Eigen::VectorXd>(direct, shares.direct.size()) = shares.direct;
  }

  /// The slice of a view: the sum of all orders, plus single scattering in closed form.
  void write_slice(std::size_t sight, Index view, double* values, double* lobes) const {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Index lights = grid_.light_mu.size();
    Eigen::Map<RowMajor> slice(values, lights, grid_.dphi.size());
    slice.noalias() = coefficients_[sight].middleRows(view * lights, lights) * waves_;
    source_->add_once(sights_[sight], view, slice);
    slice = grid_.light_mu.asDiagonal() * slice;
    if (lobes != nullptr) {
      Eigen::Map<RowMajor> facets(lobes, lights, grid_.dphi.size());
      facets.setZero();
      source_->add_lobes(sights_[sight], view, facets);
      facets = grid_.light_mu.asDiagonal() * facets;
      slice += facets;
    }
  }

 private:
  const SliceGrid& grid_;
  std::span<const Sight> sights_;
  std::unique_ptr<SliceSource> source_;
  std::vector<Eigen::MatrixXd> coefficients_;  // by sight: [view and light, order]
  Eigen::MatrixXd waves_;                      // [order, dphi]
};

}  // namespace

void evaluate_slices(std::span<const Solution* const> solutions, std::span<const Sight> sights, const SliceGrid& grid,
                     const SliceSinks& sinks, ThreadPool& pool) {
  std::vector<std::unique_ptr<Work>> work(solutions.size());
  const auto prepare = [&](std::size_t k) { work[k] = std::make_unique<Work>(*solutions[k], sights, grid, pool); };
  // Assemblies use the pool, so they are not tasks of the pool.
  if (std::all_of(solutions.begin(), solutions.end(), [](const Solution* s) { return has_only_media(s->stack()); })) {
    pool.run(work.size(), prepare);
  } else {
    for (std::size_t k = 0; k < work.size(); ++k) {
      prepare(k);
    }
  }

  std::vector<std::pair<std::size_t, int>> tasks;
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    for (int order = 0; order < work[k]->orders(); ++order) {
      tasks.emplace_back(k, order);
    }
  }
  pool.run(tasks.size(), [&](std::size_t t) { work[tasks[t].first]->solve_order(tasks[t].second); });

  const auto views = static_cast<std::size_t>(grid.view_mu.size());
  const auto lights = static_cast<std::size_t>(grid.lights());
  constexpr std::size_t kChunk = 8;  // views per task; each takes a few microseconds
  const std::size_t chunks = (views + kChunk - 1) / kChunk;
  pool.run(sights.size() * work.size() * chunks, [&](std::size_t t) {
    const std::size_t table = t / chunks;
    const std::size_t sight = table / work.size();
    const std::size_t first = t % chunks * kChunk;
    const Work& mine = *work[table % work.size()];
    if (first == 0) {
      mine.write_shares(sight, sinks.albedo + table * views, sinks.direct + table * views);
    }
    for (std::size_t view = first; view < std::min(views, first + kChunk); ++view) {
      const std::size_t first_light = (table * views + view) * lights;
      mine.write_slice(sight, static_cast<Index>(view), sinks.values + first_light,
                       sinks.lobes == nullptr ? nullptr : sinks.lobes + first_light);
    }
  });
}

}  // namespace lamina
