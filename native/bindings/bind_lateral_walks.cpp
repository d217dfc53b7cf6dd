// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the walks that carry positions.
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "lateral_walks/photon_walk.hpp"
#include "lateral_walks/plane_scattering_walk.hpp"
#include "lateral_walks/searchlight_tally.hpp"
#include "walks/walk_blocks.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

/// Knots (tau, depth in mm, sigma_t in 1/mm), top first, for each layer; none for an interface.
std::vector<DepthScale> scales_of(const std::vector<std::vector<std::tuple<double, double, double>>>& layers) {
  std::vector<DepthScale> scales;
  for (const auto& knots : layers) {
    std::vector<DepthScale::Knot> all;
    for (const auto& [tau, depth, sigma_t] : knots) {
      all.push_back({tau, depth, sigma_t});
    }
    scales.push_back(all.empty() ? DepthScale() : DepthScale(std::move(all)));
  }
  return scales;
}

/// A side of a tally as (within, within_squares, moments, products).
py::tuple side_of(const SearchlightTally::Side& side) {
  return py::make_tuple(side.within, side.within_squares, side.moments, side.products);
}

}  // namespace

void lamina::bind_lateral_walks(py::module_& module) {
  using Knots = std::vector<std::vector<std::tuple<double, double, double>>>;
  py::class_<LateralWalk>(module, "LateralWalk")
      .def_readonly("mirrored", &LateralWalk::mirrored)
      .def_readonly("unscattered", &LateralWalk::unscattered);
  module.def(
      "photon_walk",
      [](const Stack& stack, const Knots& knots, double mu_i) {
        return make_photon_walk(stack, scales_of(knots), mu_i);
      },
      py::arg("stack"), py::arg("depth_knots"), py::arg("mu_i"), py::call_guard<py::gil_scoped_release>());
  module.def(
      "plane_scattering_walk",
      [](const Stack& stack, const Knots& knots, double mu_i) {
        return make_plane_scattering_walk(stack, scales_of(knots), mu_i);
      },
      py::arg("stack"), py::arg("depth_knots"), py::arg("mu_i"), py::call_guard<py::gil_scoped_release>());
  module.def(
      "run_lateral_walk",
      [](const LateralWalk& walk, std::vector<double> radii, std::vector<double> frequencies, std::uint64_t seed,
         std::uint64_t first, std::uint64_t last, ThreadPool& pool) {
        const SearchlightScores scores{std::move(radii), std::move(frequencies)};
        const SearchlightTally tally = [&] {
          const py::gil_scoped_release release;
          return run_lateral_walk(walk, scores, seed, first, last, pool);
        }();
        return py::make_tuple(side_of(tally.sides[0]), side_of(tally.sides[1]), tally.count, tally.events);
      },
      py::arg("walk"), py::arg("radii"), py::arg("frequencies"), py::arg("seed"), py::arg("first_block"),
      py::arg("last_block"), py::arg("pool"),
      "(above, below, count, events) of blocks of WALK_BLOCK samples; a side is (within, within_squares, moments, "
      "products).");
}
