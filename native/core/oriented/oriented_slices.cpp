// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/oriented_slices.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "oriented/beam_set.hpp"
#include "oriented/oriented_evaluation.hpp"
#include "solve/homogeneous_layer.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

constexpr double kLowest = 5e-3;     // cosine of the most grazing beam
constexpr Index kMostProblems = 96;  // at once, for memory

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

/// The azimuths of the beams that are followed, of those in half a turn. The second quarter may mirror the first.
Index followed(const AzimuthBlocks& azimuths) { return azimuths.mirrored ? azimuths.orders / 2 + 1 : azimuths.orders; }

/// The beams that are followed: azimuths, and the angles of each.
std::vector<Beam> beams_of(const OrientedSolution& solution) {
  const VectorXd angles = beam_angles(solution.media().resolution().nodes);
  std::vector<Beam> beams;
  for (Index a = 0; a < followed(solution.azimuths()); ++a) {
    for (const double angle : angles) {
      const double turn = pi * static_cast<double>(a) / solution.azimuths().orders;
      beams.push_back({std::cos(angle), solution.frame() + turn, false});
    }
  }
  return beams;
}

BeamLight light_between(const OrientedSolution& solution, const BeamSet& set, ThreadPool& pool) {
  BeamLight found;
  found.angle = beam_angles(solution.media().resolution().nodes);
  const Index angles = found.angle.size();
  const Index half = solution.azimuths().orders;
  found.azimuths = 2 * half;
  const GapLight& ends = set.scattered();
  const Index count = angles * followed(solution.azimuths());
  MatrixXd parts[2][2];  // [one of both beams mirrored, one of both turned by half a turn]
  parts[0][0].resize(count, count);
  for (Index in = 0; in < count; ++in) {
    for (Index out = 0; out < count; ++out) {
      parts[0][0](out, in) = pi * set.evenly(static_cast<std::size_t>(out), static_cast<std::size_t>(in));
    }
  }
  parts[0][1] = parts[1][0] = parts[1][1] = parts[0][0];
  VectorXd albedo(count);
  for (Index first = 0; first < count; first += kMostProblems) {
    const Index size = std::min(kMostProblems, count - first);
    const GapLight light = solution.light(columns(ends, first, size));
    albedo.segment(first, size) = leaving(solution, light, true);
    for (std::size_t block = 0; block < ends.up.size(); ++block) {
      MatrixXd own = MatrixXd::Zero(count, size);
      for (std::size_t gap = 1; gap < ends.up[block].size(); ++gap) {  // no layer emits down into the first
        if (const MatrixXd& up = ends.up[block][gap]; up.cols() > 0) {
          own.noalias() += up.transpose() * light.down[block][gap];
        }
        if (const MatrixXd& down = ends.down[block][gap]; down.cols() > 0) {
          own.noalias() += down.transpose() * light.up[block][gap];
        }
      }
      // Half a turn changes the sign of odd functions. The second quarter is the first one mirrored, which changes that
      // of sines, and turned by half a turn.
      const double turned = block % 2 == 0 ? 1.0 : -1.0;
      const double mirrored = block < 2 ? turned : -turned;
      parts[0][0].middleCols(first, size) += own;
      parts[0][1].middleCols(first, size) += turned * own;
      parts[1][0].middleCols(first, size) += mirrored * own;
      parts[1][1].middleCols(first, size) += mirrored * turned * own;
    }
  }

  // What media scatter depends on the difference of azimuths alone
  std::vector<MatrixXd> media(static_cast<std::size_t>(half + 1), MatrixXd(angles, angles));
  pool.run(media.size(), [&](std::size_t step) {
    for (Index in = 0; in < angles; ++in) {
      for (Index out = 0; out < angles; ++out) {
        media[step](out, in) = set.by_media(static_cast<std::size_t>(out), static_cast<std::size_t>(in),
                                            pi * static_cast<double>(step) / static_cast<double>(half));
      }
    }
  });
  const VectorXd mu = found.angle.array().cos();
  const MatrixXd cosines = mu.replicate(1, angles) + mu.transpose().replicate(angles, 1);
  const Index quarter = count / angles;
  const auto own = [&](Index azimuth) { return angles * (azimuth < quarter ? azimuth : half - azimuth); };
  found.same.resize(angles * half, angles * half);
  found.turned.resize(angles * half, angles * half);
  found.albedo.resize(angles * half);
  for (Index in = 0; in < half; ++in) {
    found.albedo.segment(in * angles, angles) = albedo.segment(own(in), angles);
    for (Index out = 0; out < half; ++out) {
      const MatrixXd* part = parts[(in < quarter) == (out < quarter) ? 0 : 1];
      const Index step = std::abs(in - out);
      const auto sum = [&](int turned, Index difference) {
        return cosines.cwiseProduct(part[turned].block(own(out), own(in), angles, angles) / pi +
                                    media[static_cast<std::size_t>(difference)]);
      };
      found.same.block(out * angles, in * angles, angles, angles) = sum(0, step);
      found.turned.block(out * angles, in * angles, angles, angles) = sum(1, half - step);
    }
  }
  return found;
}

/// Smooth light from all beams of a whole turn to all views of one azimuth, [angle and azimuth of the beam, view].
MatrixXd to_views(const BeamLight& known, const MatrixXd& angle_shares, const VectorXd& wave_shares) {
  const Index angles = known.angle.size();
  const Index half = known.azimuths / 2;
  // At this azimuth, from beams of the first half turn and of the other
  MatrixXd light = MatrixXd::Zero(angles, 2 * angles * half);
  for (Index a = 0; a < half; ++a) {
    const auto same = known.same.middleRows(a * angles, angles);
    const auto turned = known.turned.middleRows(a * angles, angles);
    light.leftCols(angles * half) += wave_shares[a] * same + wave_shares[half + a] * turned;
    light.rightCols(angles * half) += wave_shares[a] * turned + wave_shares[half + a] * same;
  }
  return light.transpose() * angle_shares.transpose();
}

/// All cosines of a grid, views first, for the specular paths.
VectorXd all_cosines(const OrientedGrid& grid) {
  VectorXd all(grid.mu_o.size() + grid.mu_i.size());
  all << grid.mu_o, grid.mu_i;
  return all;
}

/// Light that facets scatter once, in 1/sr, from all lights to one view.
void add_facets(const OrientedSolution& solution, const SpecularPaths& paths, const OrientedGrid& grid, Index column,
                Eigen::Ref<VectorXd> light) {
  const Index views = grid.mu_o.size();
  const Index azimuths = grid.dphi.size();
  const double turn = grid.phi_o[column / views] - solution.frame();
  const SpecularPaths::Arrived out{column % views, turn};
  std::vector<SpecularPaths::Arrived> ins;
  for (const double dphi : grid.dphi) {
    ins.push_back({0, turn - dphi});
  }
  for (Index k = 0; k < light.size(); ++k) {
    SpecularPaths::Arrived& in = ins[static_cast<std::size_t>(k % azimuths)];
    in.target = views + k / azimuths;
    for (std::size_t layer = 0; layer <= solution.stack().layers.size(); ++layer) {
      if (solution.surface(layer) != nullptr) {
        light[k] += paths.by_facets(out, in, layer);
      }
    }
  }
}

/// Adds to a column, the smooth light from all lights to one view in 1/sr, the light of facets.
using AddFacets = std::function<void(Index column, Eigen::Ref<VectorXd> light)>;

OrientedSlices slices_between(const OrientedSolution& solution, const BeamSet& set, const OrientedGrid& grid,
                              const AddFacets& add, ThreadPool& pool) {
  const Index views = grid.mu_o.size();
  const Index turns = grid.phi_o.size();
  const Index azimuths = grid.dphi.size();
  const BeamLight known = light_between(solution, set, pool);
  const MatrixXd view_shares = cubics(known.angle, grid.mu_o);
  const MatrixXd light_shares = cubics(known.angle, grid.mu_i);
  const VectorXd phi_o = grid.phi_o.array() - solution.frame();
  const MatrixXd view_waves = waves(known.azimuths, 2.0 * pi, phi_o);
  const MatrixXd flux_waves = waves(known.azimuths / 2, pi, phi_o);
  const Eigen::Map<const MatrixXd> fluxes(known.albedo.data(), known.angle.size(), known.azimuths / 2);

  OrientedSlices found;
  found.values.resize(grid.mu_i.size() * azimuths, turns * views);
  const MatrixXd albedo = view_shares * fluxes * flux_waves.transpose();
  found.albedo = Eigen::Map<const VectorXd>(albedo.data(), albedo.size());
  found.mirrored = VectorXd(specular_light(solution, grid.mu_o).reflect_above).replicate(turns, 1);
  pool.run(static_cast<std::size_t>(turns), [&](std::size_t place) {
    const auto turn = static_cast<Index>(place);
    const VectorXd phi = phi_o[turn] - grid.dphi.array();
    const MatrixXd light_waves = waves(known.azimuths, 2.0 * pi, phi).transpose();
    const MatrixXd light = to_views(known, view_shares, view_waves.row(turn));
    for (Index view = 0; view < views; ++view) {
      const Eigen::Map<const MatrixXd> beams(light.col(view).data(), known.angle.size(), known.azimuths);
      const MatrixXd smooth = light_shares * beams * light_waves;
      VectorXd column(found.values.rows());
      for (Index i = 0; i < grid.mu_i.size(); ++i) {
        column.segment(i * azimuths, azimuths) = smooth.row(i).transpose() / (grid.mu_o[view] + grid.mu_i[i]);
      }
      add(turn * views + view, column);
      for (Index i = 0; i < grid.mu_i.size(); ++i) {
        column.segment(i * azimuths, azimuths) *= grid.mu_i[i];
      }
      found.values.col(turn * views + view) = column.cwiseMax(0.0).cast<float>();
    }
  });
  return found;
}

}  // namespace

OrientedSlices oriented_slices(const OrientedSolution& solution, const OrientedGrid& grid, ThreadPool& pool) {
  const BeamSet set(solution, beams_of(solution), pool);
  const SpecularPaths paths(solution, all_cosines(grid));
  return slices_between(
      solution, set, grid,
      [&](Index column, Eigen::Ref<VectorXd> light) { add_facets(solution, paths, grid, column, light); }, pool);
}

SlicesBelowMedium::SlicesBelowMedium(const OrientedSolution& bare, OrientedGrid grid, ThreadPool& pool)
    : grid_(std::move(grid)), beams_(bare, beams_of(bare), pool) {
  const SpecularPaths paths(bare, all_cosines(grid_));
  facets_.resize(grid_.mu_i.size() * grid_.dphi.size(), grid_.phi_o.size() * grid_.mu_o.size());
  pool.run(static_cast<std::size_t>(facets_.cols()), [&](std::size_t place) {
    const auto column = static_cast<Index>(place);
    VectorXd light = VectorXd::Zero(facets_.rows());
    add_facets(bare, paths, grid_, column, light);
    facets_.col(column) = light.cast<float>();
  });
}

OrientedSlices SlicesBelowMedium::of(const OrientedSolution& solution, ThreadPool& pool) const {
  const double tau = solution.media().scatterers().front().medium.tau;
  const VectorXd to_views = direct_transmissions(grid_.mu_o, tau);
  VectorXd from_lights(facets_.rows());
  for (Index i = 0; i < grid_.mu_i.size(); ++i) {
    from_lights.segment(i * grid_.dphi.size(), grid_.dphi.size())
        .setConstant(direct_transmissions(grid_.mu_i.segment(i, 1), tau)[0]);
  }
  const auto add = [&](Index column, Eigen::Ref<VectorXd> light) {
    light += to_views[column % grid_.mu_o.size()] * from_lights.cwiseProduct(facets_.col(column).cast<double>());
  };
  return slices_between(solution, BeamSet(solution, beams_, pool), grid_, add, pool);
}

}  // namespace lamina
