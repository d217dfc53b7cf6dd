// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/oriented_slices.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "oriented/beam_set.hpp"
#include "oriented/oriented_evaluation.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

constexpr double kLowest = 5e-3;  // cosine of the most grazing beam
constexpr Index kMostProblems = 192;

/// Angles from the normal to grazing, denser towards grazing.
VectorXd beam_angles(Index count) {
  VectorXd angles(count);
  for (Index k = 0; k < count; ++k) {
    const double left = 1.0 - static_cast<double>(k) / static_cast<double>(count - 1);
    angles[k] = std::acos(kLowest) * (1.0 - std::pow(left, 1.5));
  }
  return angles;
}

/// Cubic interpolation between `known`, ascending, at the angles of `mu`: [wanted, known].
MatrixXd cubics(const VectorXd& known, const VectorXd& mu) {
  MatrixXd shares = MatrixXd::Zero(mu.size(), known.size());
  for (Index k = 0; k < mu.size(); ++k) {
    const double angle = std::min(std::acos(std::min(1.0, mu[k])), known[known.size() - 1]);
    const Index above = std::upper_bound(known.begin(), known.end(), angle) - known.begin();
    const Index first = std::clamp<Index>(above - 2, 0, known.size() - 4);
    for (Index i = first; i < first + 4; ++i) {
      double share = 1.0;
      for (Index j = first; j < first + 4; ++j) {
        share *= j == i ? 1.0 : (angle - known[j]) / (known[i] - known[j]);
      }
      shares(k, i) = share;
    }
  }
  return shares;
}

/// Fourier interpolation between `count` equidistant azimuths from 0 of a function of this period, [wanted, known].
MatrixXd waves(Index count, double period, const VectorXd& phi) {
  MatrixXd shares(phi.size(), count);
  for (Index k = 0; k < phi.size(); ++k) {
    for (Index j = 0; j < count; ++j) {
      const double turn = 2.0 * pi * (phi[k] / period - static_cast<double>(j) / static_cast<double>(count));
      double sum = 1.0;
      for (Index m = 1; 2 * m <= count; ++m) {
        sum += (2 * m == count ? 1.0 : 2.0) * std::cos(static_cast<double>(m) * turn);
      }
      shares(k, j) = sum / static_cast<double>(count);
    }
  }
  return shares;
}

/// Smooth light between the beams, (mu_o + mu_i) f, which is finite at grazing, and fluxes to the top.
struct BeamLight {
  VectorXd angle;      ///< of the beams
  Index azimuths = 0;  ///< of the beams in a whole turn
  MatrixXd same;       ///< [out, in]; beams run over azimuths in half a turn, and over the angles of each
  MatrixXd turned;     ///< the same with `in` turned by half a turn
  VectorXd albedo;
};

BeamLight light_between_beams(const OrientedSolution& solution, ThreadPool& pool) {
  BeamLight found;
  found.angle = beam_angles(solution.media().resolution().nodes);
  found.azimuths = 2 * solution.azimuths().orders;
  std::vector<Beam> beams;
  for (Index a = 0; a < found.azimuths / 2; ++a) {
    for (Index k = 0; k < found.angle.size(); ++k) {
      beams.push_back(
          {std::cos(found.angle[k]), 2.0 * pi * static_cast<double>(a) / static_cast<double>(found.azimuths), false});
    }
  }
  const auto count = static_cast<Index>(beams.size());
  const BeamSet set(solution, beams, pool);
  const GapLight& ends = set.scattered();
  found.same.resize(count, count);
  found.turned.resize(count, count);
  found.albedo.resize(count);
  for (Index first = 0; first < count; first += kMostProblems) {
    const Index size = std::min(kMostProblems, count - first);
    const GapLight light = solution.light(columns(ends, first, size));
    found.albedo.segment(first, size) = leaving(solution, light, true);
    // Half a turn changes the sign of odd functions
    MatrixXd parts[2] = {MatrixXd::Zero(count, size), MatrixXd::Zero(count, size)};
    for (std::size_t block = 0; block < ends.up.size(); ++block) {
      for (std::size_t gap = 0; gap < ends.up[block].size(); ++gap) {
        parts[block % 2].noalias() += ends.up[block][gap].transpose() * light.down[block][gap];
        parts[block % 2].noalias() += ends.down[block][gap].transpose() * light.up[block][gap];
      }
    }
    found.same.middleCols(first, size) = (parts[0] + parts[1]) / pi;
    found.turned.middleCols(first, size) = (parts[0] - parts[1]) / pi;
  }
  pool.run(beams.size(), [&](std::size_t in) {
    for (std::size_t out = 0; out < beams.size(); ++out) {
      const auto o = static_cast<Index>(out);
      const auto i = static_cast<Index>(in);
      const double cosines = beams[out].mu + beams[in].mu;
      found.same(o, i) = cosines * (found.same(o, i) + set.smooth_by_one_layer(out, in, 0.0));
      found.turned(o, i) = cosines * (found.turned(o, i) + set.smooth_by_one_layer(out, in, pi));
    }
  });
  return found;
}

/// Smooth light from all beams of a whole turn to one view, [angle, azimuth].
MatrixXd to_view(const BeamLight& known, const MatrixXd& angle_shares, const MatrixXd& wave_shares, Index mu,
                 Index phi) {
  const Index angles = known.angle.size();
  const Index half = known.azimuths / 2;
  MatrixXd light = MatrixXd::Zero(angles, known.azimuths);
  VectorXd first = VectorXd::Zero(angles * half);   // shares of the views in the first half turn
  VectorXd second = VectorXd::Zero(angles * half);  // and in the second
  for (Index a = 0; a < half; ++a) {
    first.segment(a * angles, angles) = wave_shares(phi, a) * angle_shares.row(mu).transpose();
    second.segment(a * angles, angles) = wave_shares(phi, half + a) * angle_shares.row(mu).transpose();
  }
  const VectorXd near = known.same.transpose() * first + known.turned.transpose() * second;
  const VectorXd far = known.turned.transpose() * first + known.same.transpose() * second;
  light.leftCols(half) = Eigen::Map<const MatrixXd>(near.data(), angles, half);
  light.rightCols(half) = Eigen::Map<const MatrixXd>(far.data(), angles, half);
  return light;
}

/// All cosines of a grid, views first, for the specular paths.
VectorXd all_cosines(const OrientedGrid& grid) {
  VectorXd all(grid.mu_o.size() + grid.mu_i.size());
  all << grid.mu_o, grid.mu_i;
  return all;
}

}  // namespace

OrientedSlices oriented_slices(const OrientedSolution& solution, const OrientedGrid& grid, ThreadPool& pool) {
  const Index views = grid.mu_o.size();
  const Index turns = grid.phi_o.size();
  const Index azimuths = grid.dphi.size();
  const BeamLight known = light_between_beams(solution, pool);
  const MatrixXd to_views = cubics(known.angle, grid.mu_o);
  const MatrixXd to_lights = cubics(known.angle, grid.mu_i);
  const MatrixXd view_waves = waves(known.azimuths, 2.0 * pi, grid.phi_o);
  const MatrixXd flux_waves = waves(known.azimuths / 2, pi, grid.phi_o);
  const Eigen::Map<const MatrixXd> fluxes(known.albedo.data(), known.angle.size(), known.azimuths / 2);
  const SpecularPaths paths(solution, all_cosines(grid));

  OrientedSlices found;
  found.values.resize(grid.mu_i.size() * azimuths, turns * views);
  const MatrixXd albedo = to_views * fluxes * flux_waves.transpose();
  found.albedo = Eigen::Map<const VectorXd>(albedo.data(), albedo.size());
  found.mirrored = VectorXd(specular_light(solution, grid.mu_o).reflect_above).replicate(turns, 1);
  pool.run(static_cast<std::size_t>(turns * views), [&](std::size_t place) {
    const auto column = static_cast<Index>(place);
    const Index turn = column / views;
    const Index view = column % views;
    const VectorXd phi = grid.phi_o[turn] - grid.dphi.array();
    const MatrixXd smooth =
        to_lights * to_view(known, to_views, view_waves, view, turn) * waves(known.azimuths, 2.0 * pi, phi).transpose();
    const SpecularPaths::Arrived out{view, grid.phi_o[turn] - solution.frame(), false};
    for (Index i = 0; i < grid.mu_i.size(); ++i) {
      for (Index j = 0; j < azimuths; ++j) {
        double value = smooth(i, j) / (grid.mu_o[view] + grid.mu_i[i]);
        for (std::size_t layer = 0; layer <= solution.stack().layers.size(); ++layer) {
          if (solution.surface(layer) != nullptr) {
            value += paths.by_facets(out, {views + i, phi[j] - solution.frame(), false}, layer);
          }
        }
        found.values(i * azimuths + j, column) = std::max(0.0, value) * grid.mu_i[i];
      }
    }
  });
  return found;
}

}  // namespace lamina
