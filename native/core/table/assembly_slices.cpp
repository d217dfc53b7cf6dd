// SPDX-License-Identifier: GPL-3.0-or-later
#include "table/assembly_slices.hpp"

namespace lamina {

using Eigen::Index;

AssemblySlices::AssemblySlices(const Solution& solution, std::span<const Sight> sights, const SliceGrid& grid,
                               ThreadPool& pool)
    : sights_(sights),
      views_(grid.view_mu.size()),
      azimuth_(grid.dphi.array().cos()),
      assembly_(solution,
                (Eigen::VectorXd(grid.view_mu.size() + grid.light_mu.size()) << grid.view_mu, grid.light_mu).finished(),
                pool, grid.view_mu.size()),
      between_(assembly_, pool) {
  for (const Sight& sight : sights) {
    once_.try_emplace({sight.viewer, sight.path}, assembly_, sight.entry(), sight.path);
  }
}

std::vector<Eigen::MatrixXd> AssemblySlices::order(int m) {
  const ScatteringFunction rest = between_.without_single(m);
  const Index nodes = assembly_.directions().front().nodes;
  const Index lights = rest.transmit.delta.size() - nodes - views_;
  std::vector<Eigen::MatrixXd> seen;
  for (const Sight& sight : sights_) {
    const bool top = sight.viewer == Side::kTop;
    if (sight.path == Path::kReflect) {
      const Eigen::MatrixXd& kernel = top ? rest.reflect_above.kernel : rest.reflect_below.kernel;
      seen.push_back(kernel.block(nodes, nodes + views_, views_, lights));
    } else if (top) {
      // Upward transmission is the transpose of downward transmission.
      seen.push_back(rest.transmit.kernel.block(nodes + views_, nodes, lights, views_).transpose());
    } else {
      seen.push_back(rest.transmit.kernel.block(nodes, nodes + views_, views_, lights));
    }
  }
  return seen;
}

void AssemblySlices::add_once(const Sight& sight, Index view, Slice slice) const {
  const StackSingleScattering& once = once_.at({sight.viewer, sight.path});
  for (Index light = 0; light < slice.rows(); ++light) {
    slice.row(light) += once.by_media(view, views_ + light, azimuth_).matrix().transpose();
  }
}

void AssemblySlices::add_lobes(const Sight& sight, Index view, Slice slice) const {
  const StackSingleScattering& once = once_.at({sight.viewer, sight.path});
  for (Index light = 0; light < slice.rows(); ++light) {
    slice.row(light) += once.by_facets(view, views_ + light, azimuth_).matrix().transpose();
  }
}

SliceSource::Shares AssemblySlices::shares(const Sight& sight) const {
  // By reciprocity, the light seen from a side is the flux of a beam from that side.
  const Fluxes fluxes = fluxes_on(assembly_, sight.viewer);
  const Index first = assembly_.directions().front().nodes;
  const bool reflects = sight.path == Path::kReflect;
  return {(reflects ? fluxes.reflected : fluxes.transmitted).segment(first, views_),
          (reflects ? fluxes.mirrored : fluxes.direct).segment(first, views_)};
}

}  // namespace lamina
