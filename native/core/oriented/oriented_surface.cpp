// SPDX-License-Identifier: GPL-3.0-or-later
#include "oriented/oriented_surface.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "rough/merged_modes.hpp"

namespace lamina {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

Heading turned(const Heading& heading, double angle) {
  if (angle == 0.0) {
    return heading;
  }
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * heading.x - s * heading.y, s * heading.x + c * heading.y, heading.mu};
}

/// The angle of the tangent that is left when widths along the axes may be exchanged instead.
double remaining_angle(const Facets& facets, bool mirrored) { return mirrored ? 0.0 : facets.angle; }

/// The facets with the tangent along the x axis. Where all tangents lie along the axes, those of tangents along the y
/// axis have their widths exchanged.
Facets straightened(const Facets& facets, bool mirrored) {
  Facets own = facets;
  own.angle = 0.0;
  if (mirrored && std::abs(std::cos(facets.angle)) < 0.5) {
    own.alpha = facets.across();
    own.alpha_v = facets.alpha;
  }
  return own;
}

/// The part of a matrix between two functions.
template <typename Matrix>
auto part(Matrix& matrix, Index f, Index g, Index rows, Index columns) {
  return matrix.block(f * rows, g * columns, rows, columns);
}

/// The columns of some functions of [live node, function], one below the other.
VectorXd stacked(const MatrixXd& values, const std::vector<Index>& functions) {
  VectorXd all(values.rows() * static_cast<Index>(functions.size()));
  for (std::size_t f = 0; f < functions.size(); ++f) {
    all.segment(static_cast<Index>(f) * values.rows(), values.rows()) = values.col(functions[f]);
  }
  return all;
}

}  // namespace

OrientedSurface::OrientedSurface(const Facets& facets, const FacetOptics& optics, const DirectionSet& set,
                                 const AzimuthBlocks& azimuths, int fineness, ThreadPool& pool)
    : facets_(straightened(facets, azimuths.mirrored)),
      angle_(remaining_angle(facets, azimuths.mirrored)),
      optics_(optics),
      turned_optics_(optics.turned()),
      set_(set),
      own_(azimuths.orders, true),
      bundle_(facets_, fineness),
      above_(set.in_medium(optics.here, VectorXd())),
      below_(set.in_medium(optics.metal ? optics.here : optics.beyond, VectorXd())),
      to_above_(set_, above_.ior, own_.orders),
      to_below_(set_, below_.ior, own_.orders) {
  const Lobes down = lobes(Face::kTop, pool);
  const Lobes up = is_opaque() ? Lobes{} : lobes(Face::kBottom, pool);
  merge(down, up, own_);
  restore_flux(down, up);
  compensate(down, up);
  turn(azimuths);
}

OrientedSurface::Lobes OrientedSurface::lobes(Face from, ThreadPool& pool) const {
  constexpr double kFiner = 1.5;  // density of directions on the incoming side, as in LobeOperator
  const Directions& nodes = nodes_of(from);
  const Directions& others = nodes_of(from == Face::kTop ? Face::kBottom : Face::kTop);
  const LobeProjection& here = from == Face::kTop ? to_above_ : to_below_;
  const LobeProjection& there = from == Face::kTop ? to_below_ : to_above_;
  const DirectionSet fine = set_.finer_by(kFiner);
  const Directions in = fine.in_medium(nodes.ior, VectorXd());
  const MatrixXd carry = set_.carry_to(fine).topLeftCorner(in.live, nodes.live);
  std::array<MatrixXd, PoleFactor::kKinds> carries;
  for (std::size_t kind = 0; kind < carries.size(); ++kind) {
    carries[kind] =
        PoleFactor::on(kind, in).asDiagonal() * carry * PoleFactor::on(kind, nodes).cwiseInverse().asDiagonal();
  }
  const VectorXd incoming = in.ior * in.scale;
  const FacetEnds ends = ends_of(from);
  // A quarter of the azimuths is enough by symmetry.
  const Index azimuths = (own_.orders + 1) / 2;
  MatrixXd waves(azimuths, own_.count());
  std::vector<double> phi;
  for (Index j = 0; j < azimuths; ++j) {
    phi.push_back(0.5 * pi * (static_cast<double>(j) + 0.5) / static_cast<double>(azimuths));
    waves.row(j) = own_.at(phi.back()) / static_cast<double>(azimuths);
  }

  const std::size_t blocks = own_.functions.size();
  struct Sums {
    std::vector<MatrixXd> reflected;
    std::vector<MatrixXd> transmitted;
    VectorXd lost;
  };
  std::vector<Sums> sums(static_cast<std::size_t>(in.live));
  pool.run(sums.size(), [&](std::size_t i) {
    RayList reflected;
    RayList transmitted;
    std::vector<MatrixXd> ours(blocks);
    std::vector<MatrixXd> theirs(blocks);
    VectorXd lost(azimuths);
    for (Index j = 0; j < azimuths; ++j) {
      const double turn = phi[static_cast<std::size_t>(j)];
      const Heading heading = Heading::of(in.mu[static_cast<Index>(i)], std::cos(turn), std::sin(turn));
      lost[j] = 1.0 - bundle_.scatter(heading, optics_of(from), ends, reflected, transmitted);
      const auto keep = [&](std::vector<MatrixXd>& all, const MatrixXd& values) {
        for (std::size_t b = 0; b < blocks; ++b) {
          all[b].conservativeResize(values.rows() * static_cast<Index>(own_.functions[b].size()), azimuths);
          all[b].col(j) = incoming[static_cast<Index>(i)] * stacked(values, own_.functions[b]);
        }
      };
      keep(ours, here.sum(reflected));
      if (!is_opaque()) {
        keep(theirs, there.sum(transmitted));
      }
    }
    Sums& found = sums[i];
    for (std::size_t b = 0; b < blocks; ++b) {
      const MatrixXd own_waves = waves(Eigen::all, own_.functions[b]);
      found.reflected.push_back(ours[b] * own_waves);
      if (!is_opaque()) {
        found.transmitted.push_back(theirs[b] * own_waves);
      }
    }
    found.lost = incoming[static_cast<Index>(i)] * (waves(Eigen::all, own_.functions[0]).transpose() * lost);
  });

  Lobes result;
  result.reflected.resize(blocks);
  result.transmitted.resize(is_opaque() ? 0 : blocks);
  pool.run(blocks, [&](std::size_t b) {
    const Index functions = static_cast<Index>(own_.functions[b].size());
    const auto gather = [&](MatrixXd& whole, const auto& of, Index rows) {
      whole.resize(rows * functions, nodes.live * functions);
      MatrixXd columns(rows * functions, in.live);
      for (Index f = 0; f < functions; ++f) {
        for (Index i = 0; i < in.live; ++i) {
          columns.col(i) = of(sums[static_cast<std::size_t>(i)])[b].col(f);
        }
        const int order = own_.order_of(own_.functions[b][static_cast<std::size_t>(f)]);
        whole.middleCols(f * nodes.live, nodes.live).noalias() = columns * carries[PoleFactor::kind_of(order)];
      }
    };
    gather(
        result.reflected[b], [](const Sums& one) -> const std::vector<MatrixXd>& { return one.reflected; }, nodes.live);
    if (!is_opaque()) {
      gather(
          result.transmitted[b], [](const Sums& one) -> const std::vector<MatrixXd>& { return one.transmitted; },
          others.live);
    }
  });
  const Index functions = static_cast<Index>(own_.functions[0].size());
  MatrixXd lost(functions, in.live);
  for (Index i = 0; i < in.live; ++i) {
    lost.col(i) = sums[static_cast<std::size_t>(i)].lost;
  }
  const MatrixXd on_nodes = (lost * carry).transpose();
  result.lost = Eigen::Map<const VectorXd>(on_nodes.data(), on_nodes.size());
  return result;
}

void OrientedSurface::merge(const Lobes& above, const Lobes& below, const AzimuthBlocks& azimuths) {
  const Index n = above_.live;
  const Index m = below_.live;
  std::vector<Modes> over;
  std::vector<Modes> under;
  for (std::size_t kind = 0; kind < PoleFactor::kKinds; ++kind) {
    over.emplace_back(set_, above_, PoleFactor::on(kind, above_));
    under.emplace_back(set_, below_, PoleFactor::on(kind, below_));
  }
  for (std::size_t b = 0; b < azimuths.functions.size(); ++b) {
    const Index functions = static_cast<Index>(azimuths.functions[b].size());
    const auto kind_of = [&](Index f) {
      return PoleFactor::kind_of(azimuths.order_of(azimuths.functions[b][static_cast<std::size_t>(f)]));
    };
    Block block;
    block.reflect_above.resize(n * functions, n * functions);
    if (!is_opaque()) {
      block.transmit.resize(m * functions, n * functions);
      block.reflect_below.resize(m * functions, m * functions);
    }
    for (Index f = 0; f < functions; ++f) {
      for (Index g = 0; g < functions; ++g) {
        const std::size_t out = kind_of(f);
        const std::size_t in = kind_of(g);
        const auto reflection = [&](MatrixXd& to, const MatrixXd& rays, const std::vector<Modes>& own, Index size) {
          if (g <= f) {
            const MatrixXd one = merged(part(rays, f, g, size, size), part(rays, g, f, size, size), own[out], own[in]);
            part(to, f, g, size, size) = one;
            part(to, g, f, size, size) = one.transpose();
          }
        };
        reflection(block.reflect_above, above.reflected[b], over, n);
        if (!is_opaque()) {
          reflection(block.reflect_below, below.reflected[b], under, m);
          part(block.transmit, f, g, m, n) = merged(part(above.transmitted[b], f, g, m, n),
                                                    part(below.transmitted[b], g, f, n, m), under[out], over[in]);
        }
      }
    }
    for (MatrixXd* one : {&block.reflect_above, &block.reflect_below}) {
      *one = (0.5 * (*one + one->transpose())).eval();  // removes the asymmetry of rounding
    }
    blocks_.push_back(std::move(block));
  }
}

/// Restores the flux out of each node, by azimuth, that merging changed: a factor of the azimuth at each node.
void OrientedSurface::restore_flux(const Lobes& above, const Lobes& below) {
  const auto restore = [&](MatrixXd& reflection, const VectorXd& missing, const VectorXd& c) {
    const std::vector<Index>& functions = own_.functions[0];
    const Index count = static_cast<Index>(functions.size());
    const Index points = 2 * own_.orders;
    MatrixXd waves(count, points);
    for (Index p = 0; p < points; ++p) {
      const double phi = pi * (static_cast<double>(p) + 0.5) / static_cast<double>(points);
      waves.col(p) = own_.at(phi)(functions);
    }
    const Index n = c.size();
    for (Index k = 0; k < n; ++k) {
      VectorXd factor = VectorXd::Zero(points);
      for (Index f = 0; f < count; ++f) {
        factor += missing[f * n + k] / c[k] * waves.row(f).transpose();
      }
      const MatrixXd product = waves * factor.asDiagonal() * waves.transpose() / static_cast<double>(points);
      for (Index f = 0; f < count; ++f) {
        for (Index g = 0; g < count; ++g) {
          reflection(f * n + k, g * n + k) += product(f, g);
        }
      }
    }
  };
  const VectorXd over = common(Face::kTop);
  const VectorXd under = common(Face::kBottom);
  Block& mean = blocks_.front();
  VectorXd missing_above =
      above.reflected[0].topRows(over.size()).transpose() * over - mean.reflect_above.leftCols(over.size()) * over;
  if (!is_opaque()) {
    missing_above += (above.transmitted[0] - mean.transmit).topRows(under.size()).transpose() * under;
    VectorXd missing_below = below.reflected[0].topRows(under.size()).transpose() * under -
                             mean.reflect_below.leftCols(under.size()) * under;
    missing_below +=
        below.transmitted[0].topRows(over.size()).transpose() * over - mean.transmit.leftCols(over.size()) * over;
    restore(mean.reflect_below, missing_below, under);
  }
  restore(mean.reflect_above, missing_above, over);
}

void OrientedSurface::compensate(const Lobes& above, const Lobes& below) {
  const VectorXd over = common(Face::kTop);
  const VectorXd under = common(Face::kBottom);
  if (facets_.compensate) {
    double whole = above.lost.head(over.size()).dot(over);
    if (is_opaque()) {
      const double fresnel = optics_.mean_reflectance();
      const double lost = whole / over.squaredNorm();
      share_ = whole > 0.0 ? fresnel * fresnel * (1.0 - lost) / (1.0 - fresnel * lost) / whole : 0.0;
    } else {
      whole += below.lost.head(under.size()).dot(under);
      share_ = whole > 0.0 ? 1.0 / whole : 0.0;
    }
  }
  Block& mean = blocks_.front();
  mean.reflect_above += share_ * above.lost * above.lost.transpose();
  const auto spread = [&](const VectorXd& lost, Index n) {
    MatrixXd all = MatrixXd::Zero(n, own_.count());
    all(Eigen::all, own_.functions[0]) = Eigen::Map<const MatrixXd>(lost.data(), n, lost.size() / n);
    return own_.turned(all, angle_);
  };
  lost_above_ = spread(above.lost, over.size());
  if (!is_opaque()) {
    mean.reflect_below += share_ * below.lost * below.lost.transpose();
    mean.transmit += share_ * below.lost * above.lost.transpose();
    lost_below_ = spread(below.lost, under.size());
  }
}

/// Turns the blocks of cosines and of sines into those of even and of odd functions, with the tangent at its angle.
void OrientedSurface::turn(const AzimuthBlocks& azimuths) {
  if (azimuths.mirrored) {
    return;
  }
  std::vector<Block> all(2);
  for (std::size_t parity = 0; parity < 2; ++parity) {
    const std::vector<Index>& functions = azimuths.functions[parity];
    const std::vector<Index>& cosines = own_.functions[parity];
    const std::vector<Index>& sines = own_.functions[parity + 2];
    const Index count = static_cast<Index>(functions.size());
    // Column f: function f of the tangent's frame, in the functions of the solve.
    MatrixXd unit = MatrixXd::Zero(count, own_.count());
    for (Index f = 0; f < count; ++f) {
      unit(f, functions[static_cast<std::size_t>(f)]) = 1.0;
    }
    const MatrixXd rotation = own_.turned(unit, angle_)(Eigen::all, functions).transpose();
    const auto rotated = [&](const MatrixXd& even, const MatrixXd& odd, Index rows, Index columns) -> MatrixXd {
      const Index first = static_cast<Index>(cosines.size());
      const Index second = static_cast<Index>(sines.size());
      MatrixXd whole = MatrixXd::Zero(rows * count, columns * count);
      for (Index f = 0; f < count; ++f) {
        for (Index g = 0; g < count; ++g) {
          auto target = part(whole, f, g, rows, columns);
          // A function mixes with that of its own order only.
          for (Index p = 0; p < first; ++p) {
            for (Index q = 0; q < first; ++q) {
              const double factor = rotation(f, p) * rotation(g, q);
              if (factor != 0.0) {
                target += factor * part(even, p, q, rows, columns);
              }
            }
          }
          for (Index p = 0; p < second; ++p) {
            for (Index q = 0; q < second; ++q) {
              const double factor = rotation(f, first + p) * rotation(g, first + q);
              if (factor != 0.0) {
                target += factor * part(odd, p, q, rows, columns);
              }
            }
          }
        }
      }
      return whole;
    };
    const Block& even = blocks_[parity];
    const Block& odd = blocks_[parity + 2];
    all[parity].reflect_above = rotated(even.reflect_above, odd.reflect_above, above_.live, above_.live);
    if (!is_opaque()) {
      all[parity].transmit = rotated(even.transmit, odd.transmit, below_.live, above_.live);
      all[parity].reflect_below = rotated(even.reflect_below, odd.reflect_below, below_.live, below_.live);
    }
  }
  blocks_ = std::move(all);
}

OrientedSurface::Column OrientedSurface::column(Face from, const Heading& in) const {
  RayList reflected;
  RayList transmitted;
  Column column;
  column.lost = 1.0 - bundle_.scatter(turned(in, -angle_), optics_of(from), ends_of(from), reflected, transmitted);
  const RayList& up = from == Face::kTop ? reflected : transmitted;
  const RayList& down = from == Face::kTop ? transmitted : reflected;
  const double returned = share_ * column.lost;
  column.above = own_.turned(to_above_.sum(up), angle_) + returned * lost_above_;
  if (!is_opaque()) {
    column.below = own_.turned(to_below_.sum(down), angle_) + returned * lost_below_;
  }
  return column;
}

double OrientedSurface::once(Face from, Face to, const Heading& in, const Heading& out) const {
  return facet_value(facets_, optics_of(from), turned(in, -angle_), turned(out, -angle_), from != to);
}

}  // namespace lamina
