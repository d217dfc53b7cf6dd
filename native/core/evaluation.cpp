// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "single_scattering.hpp"

namespace lamina {
namespace {

using std::numbers::pi;

/// Sorted cosines without repetition, and where each of the given ones stands among them.
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

/// For each azimuth order, the part of pi f that is smooth, between all targets.
std::vector<Eigen::MatrixXd> smooth_orders(const Solution& solution, Side side, Path path,
                                           const Eigen::VectorXd& targets, ThreadPool& pool) {
  const Directions directions(solution.quadrature(), targets);
  std::vector<Eigen::MatrixXd> orders(static_cast<std::size_t>(solution.orders()));
  pool.run(orders.size(), [&](std::size_t m) {
    const ScatteringFunction rest = solution.without_single(directions, static_cast<int>(m));
    orders[m] = kernel_of(rest, side, path).bottomRightCorner(targets.size(), targets.size());
  });
  return orders;
}

/// Light scattered once by a medium, attenuated by the layers that it passes, with the true phase function.
class SingleScattering {
 public:
  SingleScattering(const Solution& solution, Side side, Path path) : path_(path) {
    const std::size_t count = solution.media().size();
    const bool closed = solution.stack().base.kind != Base::Kind::kNone;
    dark_ = closed && (path == Path::kTransmit || side == Side::kBottom);
    double depth = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t layer = side == Side::kTop ? k : count - 1 - k;
      const TruncatedMedium& medium = solution.media()[layer];
      terms_.push_back(
          {medium.tau, depth, 0.25 / pi * medium.single_scattering_albedo(), &solution.stack().layers[layer].phase});
      depth += medium.tau;
    }
    whole_ = depth;
  }

  double operator()(double mu_o, double mu_i, double dphi) const {
    if (dark_) {
      return 0.0;
    }
    const double sines = std::sqrt((1.0 - mu_o * mu_o) * (1.0 - mu_i * mu_i)) * std::cos(dphi);
    double sum = 0.0;
    for (const Term& term : terms_) {
      if (path_ == Path::kReflect) {
        const double reach = std::isinf(term.before) ? 0.0 : std::exp(-term.before * (1.0 / mu_o + 1.0 / mu_i));
        sum +=
            term.weight * reach * term.phase->evaluate(sines - mu_o * mu_i) * single_reflection(mu_o, mu_i, term.tau);
      } else if (!std::isinf(whole_)) {
        const double after = whole_ - term.before - term.tau;
        sum += term.weight * std::exp(-term.before / mu_i - after / mu_o) * term.phase->evaluate(sines + mu_o * mu_i) *
               single_transmission(mu_o, mu_i, term.tau);
      }
    }
    return sum;
  }

 private:
  struct Term {
    double tau;
    double before;  // optical depth that light crosses before it enters this layer
    double weight;
    const PhaseFunction* phase;
  };
  Path path_;
  bool dark_ = false;
  double whole_ = 0.0;
  std::vector<Term> terms_;
};

/// Lagrange's interpolation on six neighbouring knots of a uniform grid in the angle, for lists too long
/// to be targets themselves.
struct AngleTable {
  static constexpr Eigen::Index kKnots = 161;
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

Fluxes fluxes_on(const Solution& solution, Side side, const Directions& directions) {
  ScatteringFunction s = solution.joined(directions, 0);
  if (side == Side::kBottom) {
    s = s.reversed();
  }
  // A target's kernel lacks its own scale: sum over nodes of pi f (2 mu w) remains.
  const Eigen::Index nodes = directions.nodes;
  const Eigen::VectorXd sums = directions.scale.head(nodes);
  Fluxes result;
  result.reflected = s.reflect_above.kernel.leftCols(nodes) * sums;
  const Eigen::VectorXd passed = s.transmit.kernel.topRows(nodes).transpose() * sums;
  // The direct beam of the true, not the truncated, thickness; the rest counts as scattered.
  double tau = 0.0;
  for (const Medium& medium : solution.stack().layers) {
    tau += medium.tau;
  }
  const bool open = solution.stack().base.kind == Base::Kind::kNone;
  result.direct = Eigen::VectorXd::Zero(directions.size());
  if (open) {
    result.direct = direct_transmissions(directions.mu, tau);
  }
  result.transmitted = passed + (s.transmit.delta - result.direct).cwiseProduct(directions.scale);
  return result;
}

}  // namespace

std::vector<double> evaluate_grid(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                  const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
  const Targets targets({&mu_o, &mu_i});
  const std::vector<Eigen::MatrixXd> orders = smooth_orders(solution, side, path, targets.mu, pool);
  const SingleScattering single(solution, side, path);
  Eigen::MatrixXd waves(static_cast<Eigen::Index>(orders.size()), dphi.size());
  for (Eigen::Index m = 0; m < waves.rows(); ++m) {
    waves.row(m) = (m == 0 ? 1.0 : 2.0) / pi * (static_cast<double>(m) * dphi.array()).cos();
  }
  std::vector<double> values(static_cast<std::size_t>(mu_o.size() * mu_i.size() * dphi.size()));
  pool.run(static_cast<std::size_t>(mu_o.size()), [&](std::size_t row) {
    const double cosine_o = mu_o[static_cast<Eigen::Index>(row)];
    const Eigen::Index o = targets.find(cosine_o);
    Eigen::MatrixXd coefficients(mu_i.size(), waves.rows());
    for (Eigen::Index i = 0; i < mu_i.size(); ++i) {
      const Eigen::Index column = targets.find(mu_i[i]);
      for (Eigen::Index m = 0; m < waves.rows(); ++m) {
        coefficients(i, m) = orders[static_cast<std::size_t>(m)](o, column);
      }
    }
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> slice(
        values.data() + row * static_cast<std::size_t>(mu_i.size() * dphi.size()), mu_i.size(), dphi.size());
    slice.noalias() = coefficients * waves;
    for (Eigen::Index i = 0; i < mu_i.size(); ++i) {
      for (Eigen::Index p = 0; p < dphi.size(); ++p) {
        slice(i, p) += single(cosine_o, mu_i[i], dphi[p]);
      }
    }
  });
  return values;
}

std::vector<double> evaluate_points(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                                    const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
  const Targets exact({&mu_o, &mu_i});
  const bool tabulate = exact.mu.size() > AngleTable::kKnots;
  const std::vector<Eigen::MatrixXd> orders =
      smooth_orders(solution, side, path, tabulate ? AngleTable::cosines() : exact.mu, pool);
  const SingleScattering single(solution, side, path);
  std::vector<double> values(static_cast<std::size_t>(mu_o.size()));
  constexpr std::size_t kChunk = 1024;
  pool.run((values.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    for (std::size_t k = chunk * kChunk; k < std::min(values.size(), (chunk + 1) * kChunk); ++k) {
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
      values[k] = sum / pi + single(o, i, dphi[point]);
    }
  });
  return values;
}

Fluxes fluxes(const Solution& solution, Side side, const Eigen::VectorXd& mu) {
  const Directions directions(solution.quadrature(), mu);
  Fluxes result = fluxes_on(solution, side, directions);
  result.reflected = result.reflected.tail(mu.size()).eval();
  result.transmitted = result.transmitted.tail(mu.size()).eval();
  result.direct = result.direct.tail(mu.size()).eval();
  return result;
}

Fluxes diffuse_fluxes(const Solution& solution, Side side) {
  const Directions directions(solution.quadrature(), Eigen::VectorXd());
  Fluxes result = fluxes_on(solution, side, directions);
  // Nodes carry one factor of the scale already.
  const auto total = [&](const Eigen::VectorXd& by_node) {
    return Eigen::VectorXd::Constant(1, by_node.dot(directions.scale)).eval();
  };
  result.reflected = total(result.reflected);
  result.transmitted = total(result.transmitted);
  result.direct = total(result.direct.cwiseProduct(directions.scale));
  return result;
}

}  // namespace lamina
