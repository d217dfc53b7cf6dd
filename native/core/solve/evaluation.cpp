// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "solve/angle_table.hpp"
#include "solve/assembly.hpp"
#include "solve/facet_meetings.hpp"
#include "solve/scattering_between_lobes.hpp"
#include "solve/stack_single_scattering.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Sorted cosines without duplicates; find() returns the index of a given cosine.
struct Targets {
  Eigen::VectorXd mu;

  explicit Targets(const std::vector<const Eigen::VectorXd*>& lists) {
    std::vector<double> all;
    for (const Eigen::VectorXd* list : lists) {
      all.insert(all.end(), list->begin(), list->end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    mu = Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }

  Eigen::Index find(double cosine) const { return std::lower_bound(mu.begin(), mu.end(), cosine) - mu.begin(); }
};

Eigen::MatrixXd kernel_of(const ScatteringFunction& s, Side side, Path path) {
  if (path == Path::kReflect) {
    return side == Side::kTop ? s.reflect_above.kernel : s.reflect_below.kernel;
  }
  if (side == Side::kTop) {
    return s.transmit.kernel;
  }
  return s.transmit.kernel.transpose();
}

}  // namespace

std::vector<std::vector<Eigen::MatrixXd>> smooth_orders(const Assembly& assembly, const FacetMeetings& meetings,
                                                        const ScatteringBetweenLobes& between,
                                                        const std::vector<Passage>& passages, ThreadPool& pool) {
  const Eigen::Index targets = assembly.directions().front().targets;
  const auto count = static_cast<std::size_t>(between.orders());
  std::vector<std::vector<Eigen::MatrixXd>> orders(passages.size(), std::vector<Eigen::MatrixXd>(count));
  pool.run(count, [&](std::size_t m) {
    ScatteringFunction rest = between.without_single(static_cast<int>(m));
    if (static_cast<int>(m) < assembly.solution().orders()) {
      meetings.take_from(rest, static_cast<int>(m));
    }
    for (std::size_t k = 0; k < passages.size(); ++k) {
      orders[k][m] = kernel_of(rest, passages[k].side, passages[k].path).bottomRightCorner(targets, targets);
    }
  });
  return orders;
}

std::vector<double> evaluate_grid(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                  const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
  return std::move(evaluate_grids(solution, {{side, path}}, mu_o, mu_i, dphi, pool).front());
}

std::vector<std::vector<double>> evaluate_grids(const Solution& solution, const std::vector<Passage>& passages,
                                                const Eigen::VectorXd& mu_o, const Eigen::VectorXd& mu_i,
                                                const Eigen::VectorXd& dphi, ThreadPool& pool) {
  const Targets targets({&mu_o, &mu_i});
  const Assembly assembly(solution, targets.mu, pool);
  const FacetMeetings meetings(assembly);
  const ScatteringBetweenLobes between(assembly, pool);
  const std::vector<std::vector<Eigen::MatrixXd>> all = smooth_orders(assembly, meetings, between, passages, pool);
  const Eigen::ArrayXd cosines = dphi.array().cos();
  Eigen::MatrixXd waves(static_cast<Eigen::Index>(between.orders()), dphi.size());
  for (Eigen::Index m = 0; m < waves.rows(); ++m) {
    waves.row(m) = (m == 0 ? 1.0 : 2.0) / pi * (static_cast<double>(m) * dphi.array()).cos();
  }
  std::vector<std::vector<double>> grids(passages.size());
  for (std::size_t k = 0; k < passages.size(); ++k) {
    const std::vector<Eigen::MatrixXd>& orders = all[k];
    const StackSingleScattering once(assembly, passages[k].side, passages[k].path);
    std::vector<double>& values = grids[k];
    values.resize(static_cast<std::size_t>(mu_o.size() * mu_i.size() * dphi.size()));
    pool.run(static_cast<std::size_t>(mu_o.size()), [&](std::size_t row) {
      const Eigen::Index o = targets.find(mu_o[static_cast<Eigen::Index>(row)]);
      Eigen::MatrixXd coefficients(mu_i.size(), waves.rows());
      for (Eigen::Index i = 0; i < mu_i.size(); ++i) {
        const Eigen::Index column = targets.find(mu_i[i]);
        for (Eigen::Index m = 0; m < waves.rows(); ++m) {
          coefficients(i, m) = orders[static_cast<std::size_t>(m)](o, column);
        }
      }
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> plane(
          values.data() + row * static_cast<std::size_t>(mu_i.size() * dphi.size()), mu_i.size(), dphi.size());
      plane.noalias() = coefficients * waves;
      for (Eigen::Index i = 0; i < mu_i.size(); ++i) {
        const Eigen::Index column = targets.find(mu_i[i]);
        plane.row(i) += once(o, column, cosines).matrix().transpose();
        plane.row(i) +=
            meetings.value(passages[k].side, passages[k].path, o, column, dphi.array()).matrix().transpose();
        plane.row(i) = plane.row(i).cwiseMax(0.0);
      }
    });
  }
  return grids;
}

namespace {

std::shared_ptr<const AngleTable> table_of(const Solution& solution, Side side, Path path, ThreadPool& pool) {
  const std::size_t number = (side == Side::kTop ? 0 : 1) + (path == Path::kReflect ? 0 : 2);
  return solution.kept_tables().known_or_made(number, [&] {
    const Assembly smooth(solution, AngleTable::cosines(), pool);
    const FacetMeetings meetings(smooth);
    const ScatteringBetweenLobes between(smooth, pool);
    return std::make_shared<const AngleTable>(smooth_orders(smooth, meetings, between, {{side, path}}, pool).front(),
                                              !meetings.none());
  });
}

/// True if values are read from the kept table: for many directions, and for one pair of directions, which a renderer
/// asks for again and again, where rough boundaries make other values slow. The choice depends on the directions alone,
/// not on earlier calls.
bool reads_table(const Solution& solution, Eigen::Index directions) {
  constexpr int kMostOrders = 64;  // with more orders the table of one pair takes seconds
  const bool slow = !solution.boundaries().empty() && solution.orders() <= kMostOrders;
  return directions > AngleTable::kKnots || (directions <= 2 && slow);
}

}  // namespace

std::vector<double> evaluate_points(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                    const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
  const Targets exact({&mu_o, &mu_i});
  std::shared_ptr<const AngleTable> table;
  std::vector<Eigen::MatrixXd> orders;
  if (reads_table(solution, exact.mu.size())) {
    table = table_of(solution, side, path, pool);
  } else {
    const Assembly smooth(solution, exact.mu, pool);
    const FacetMeetings meetings(smooth);
    orders =
        std::move(smooth_orders(smooth, meetings, ScatteringBetweenLobes(smooth, pool), {{side, path}}, pool).front());
  }
  const Assembly all(solution, exact.mu);
  std::optional<FacetMeetings> meetings;
  if (!table || table->meets()) {
    meetings.emplace(all);
  }
  const StackSingleScattering once(all, side, path);
  std::vector<double> values(static_cast<std::size_t>(mu_o.size()));
  const std::size_t chunk_size = meetings && !meetings->none() ? 64 : 1024;
  pool.run((values.size() + chunk_size - 1) / chunk_size, [&](std::size_t chunk) {
    for (std::size_t k = chunk * chunk_size; k < std::min(values.size(), (chunk + 1) * chunk_size); ++k) {
      const auto point = static_cast<Eigen::Index>(k);
      const Eigen::Index row = exact.find(mu_o[point]);
      const Eigen::Index column = exact.find(mu_i[point]);
      Eigen::ArrayXd waves(static_cast<Eigen::Index>(orders.size()));
      if (table) {
        waves = table->at(mu_o[point], mu_i[point]);
      } else {
        for (std::size_t m = 0; m < orders.size(); ++m) {
          waves[static_cast<Eigen::Index>(m)] = orders[m](row, column);
        }
      }
      double sum = waves.size() > 0 ? -waves[0] : 0.0;
      for (Eigen::Index m = 0; m < waves.size(); ++m) {
        sum += 2.0 * std::cos(static_cast<double>(m) * dphi[point]) * waves[m];
      }
      sum = sum / pi + once(row, column, Eigen::ArrayXd::Constant(1, std::cos(dphi[point])))[0];
      if (meetings) {
        sum += meetings->value(side, path, row, column, Eigen::ArrayXd::Constant(1, dphi[point]))[0];
      }
      values[k] = std::max(0.0, sum);  // negative values are within the tolerance, see check_returned
    }
  });
  return values;
}

Fluxes fluxes_on(const Assembly& assembly, Side side) {
  const Solution& solution = assembly.solution();
  const std::vector<Directions>& directions = assembly.directions();
  ScatteringFunction s = assembly.joined(0);
  if (side == Side::kBottom) {
    s = s.reversed();
  }
  const Directions& entry = side == Side::kTop ? directions.front() : directions.back();
  const Directions& exit = side == Side::kTop ? directions.back() : directions.front();
  // The flux of scaled radiance is its scalar product with C = n scale.
  const auto flux = [](const Directions& where) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(where.nodes);
    all.head(where.live) = where.ior * where.scale.head(where.live);
    return all;
  };
  const Eigen::VectorXd own = entry.ior * entry.spread(entry.scale);
  Fluxes result;
  result.reflected = s.reflect_above.kernel.leftCols(entry.nodes) * flux(entry);
  result.mirrored = s.reflect_above.delta.cwiseProduct(own);
  const Eigen::VectorXd passed = s.transmit.kernel.topRows(entry.nodes).transpose() * flux(exit);
  // The direct beam passes the true thickness, not the truncated one; the rest of the transmitted light counts as
  // scattered.
  Eigen::VectorXd longer = Eigen::VectorXd::Zero(own.size());
  for (const Solution::Scatterer& scatterer : solution.scatterers()) {
    const Directions& here = directions[scatterer.layer];
    const double tau = std::get<Medium>(solution.stack().layers[scatterer.layer]).tau;
    const double shortened = std::isinf(tau) ? 0.0 : tau - scatterer.medium.tau;
    longer += here.spread((shortened * here.mu.cwiseInverse()).eval());
  }
  result.direct = s.transmit.delta.cwiseProduct((-longer.array()).exp().matrix()).cwiseProduct(own);
  result.transmitted = passed + s.transmit.delta.cwiseProduct(own) - result.direct;
  return result;
}

Fluxes fluxes(const Solution& solution, Side side, const Eigen::VectorXd& mu, ThreadPool& pool) {
  // Evaluate in parts: an assembly joins every target with every other target.
  constexpr Eigen::Index kPart = 96;
  Fluxes result;
  const auto parts = [](Fluxes& f) { return std::array{&f.reflected, &f.mirrored, &f.transmitted, &f.direct}; };
  for (Eigen::VectorXd* part : parts(result)) {
    part->resize(mu.size());
  }
  for (Eigen::Index first = 0; first < mu.size(); first += kPart) {
    const Eigen::Index count = std::min(kPart, mu.size() - first);
    Fluxes some = fluxes_on(Assembly(solution, mu.segment(first, count), pool), side);
    for (std::size_t k = 0; k < parts(result).size(); ++k) {
      parts(result)[k]->segment(first, count) = parts(some)[k]->tail(count);
    }
  }
  return result;
}

Fluxes diffuse_fluxes(const Solution& solution, Side side, ThreadPool& pool) {
  const Assembly assembly(solution, Eigen::VectorXd(), pool);
  const std::vector<Directions>& directions = assembly.directions();
  const Directions& entry = side == Side::kTop ? directions.front() : directions.back();
  Fluxes result = fluxes_on(assembly, side);
  const Eigen::VectorXd flux = entry.scale / entry.ior;
  for (Eigen::VectorXd* part : {&result.reflected, &result.mirrored, &result.transmitted, &result.direct}) {
    *part = Eigen::VectorXd::Constant(1, part->head(entry.live).dot(flux));
  }
  return result;
}

}  // namespace lamina
