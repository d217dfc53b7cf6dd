// SPDX-License-Identifier: GPL-3.0-or-later
#include "solve/evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

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

/// Lagrange interpolation on six neighbouring knots of a uniform grid in the angle, for lists of cosines that are too
/// long to be targets themselves.
struct AngleTable {
  static constexpr Eigen::Index kKnots = 241;
  static constexpr Eigen::Index kStencil = 6;

  static Eigen::VectorXd cosines() {
    Eigen::VectorXd mu(kKnots);
    for (Eigen::Index k = 0; k < kKnots; ++k) {
      mu[k] = std::max(1e-6, std::cos(0.5 * pi * static_cast<double>(k) / static_cast<double>(kKnots - 1)));
    }
    return mu;
  }

  struct Stencil {
    Eigen::Index first;
    std::array<double, kStencil> weights;
  };
  static Stencil stencil(double mu) {
    const double x = std::acos(std::min(mu, 1.0)) / (0.5 * pi) * static_cast<double>(kKnots - 1);
    Stencil s{};
    s.first = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(x) - kStencil / 2 + 1, 0, kKnots - kStencil);
    for (std::size_t a = 0; a < kStencil; ++a) {
      double weight = 1.0;
      for (std::size_t b = 0; b < kStencil; ++b) {
        if (b != a) {
          weight *= (x - static_cast<double>(s.first) - static_cast<double>(b)) /
                    (static_cast<double>(a) - static_cast<double>(b));
        }
      }
      s.weights[a] = weight;
    }
    return s;
  }
};

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

std::vector<double> evaluate_points(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                    const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
  const Targets exact({&mu_o, &mu_i});
  const bool tabulate = exact.mu.size() > AngleTable::kKnots;
  const Assembly smooth(solution, tabulate ? AngleTable::cosines() : exact.mu, pool);
  const std::vector<Eigen::MatrixXd> orders = std::move(
      smooth_orders(smooth, FacetMeetings(smooth), ScatteringBetweenLobes(smooth, pool), {{side, path}}, pool).front());
  const Assembly all(solution, exact.mu);
  const FacetMeetings meetings(all);
  const StackSingleScattering once(all, side, path);
  std::vector<double> values(static_cast<std::size_t>(mu_o.size()));
  const std::size_t chunk_size = meetings.none() ? 1024 : 64;
  pool.run((values.size() + chunk_size - 1) / chunk_size, [&](std::size_t chunk) {
    for (std::size_t k = chunk * chunk_size; k < std::min(values.size(), (chunk + 1) * chunk_size); ++k) {
      const auto point = static_cast<Eigen::Index>(k);
      const double o = mu_o[point];
      const double i = mu_i[point];
      const auto read = [&](const Eigen::MatrixXd& order) {
        if (!tabulate) {
          return order(exact.find(o), exact.find(i));
        }
        const AngleTable::Stencil rows = AngleTable::stencil(o);
        const AngleTable::Stencil columns = AngleTable::stencil(i);
        double sum = 0.0;
        for (std::size_t a = 0; a < rows.weights.size(); ++a) {
          for (std::size_t b = 0; b < columns.weights.size(); ++b) {
            sum += rows.weights[a] * columns.weights[b] *
                   order(rows.first + static_cast<Eigen::Index>(a), columns.first + static_cast<Eigen::Index>(b));
          }
        }
        return sum;
      };
      double sum = 0.0;
      for (std::size_t m = 0; m < orders.size(); ++m) {
        sum += (m == 0 ? 1.0 : 2.0) * std::cos(static_cast<double>(m) * dphi[point]) * read(orders[m]);
      }
      const Eigen::Index row = exact.find(o);
      const Eigen::Index column = exact.find(i);
      sum = sum / pi + once(row, column, Eigen::ArrayXd::Constant(1, std::cos(dphi[point])))[0] +
            meetings.value(side, path, row, column, Eigen::ArrayXd::Constant(1, dphi[point]))[0];
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
