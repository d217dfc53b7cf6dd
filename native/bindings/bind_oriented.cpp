// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the solver of stacks with anisotropic facets.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <utility>

#include "bindings.hpp"
#include "oriented/oriented_evaluation.hpp"
#include "oriented/oriented_slices.hpp"

namespace py = pybind11;

namespace {

std::tuple<Eigen::MatrixXf, Eigen::VectorXd, Eigen::VectorXd> parts_of(lamina::OrientedSlices found) {
  return {std::move(found.values), std::move(found.albedo), std::move(found.mirrored)};
}

}  // namespace

void lamina::bind_oriented(py::module_& module) {
  const auto unlocked = py::call_guard<py::gil_scoped_release>();
  py::class_<OrientedSolution>(module, "OrientedSolution")
      .def_property_readonly("nodes", [](const OrientedSolution& s) { return s.media().resolution().nodes; })
      .def_property_readonly("orders", [](const OrientedSolution& s) { return s.azimuths().orders; })
      .def_property_readonly("checks", &OrientedSolution::checks)
      .def(
          "points",
          [](const OrientedSolution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
             const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, const Eigen::VectorXd& phi_o,
             ThreadPool& pool) -> Eigen::VectorXd {
            const std::vector<double> values = evaluate_oriented(solution, side, path, {mu_o, mu_i, dphi, phi_o}, pool);
            return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
          },
          py::arg("side"), py::arg("path"), py::arg("mu_o"), py::arg("mu_i"), py::arg("dphi"), py::arg("phi_o"),
          py::arg("pool"), unlocked)
      .def("fluxes", &oriented_fluxes, py::arg("side"), py::arg("mu"), py::arg("phi"), py::arg("pool"), unlocked)
      .def(
          "slices",
          [](const OrientedSolution& solution, const Eigen::VectorXd& mu_o, const Eigen::VectorXd& phi_o,
             const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
            return parts_of(oriented_slices(solution, OrientedGrid{mu_o, phi_o, mu_i, dphi}, pool));
          },
          py::arg("mu_o"), py::arg("phi_o"), py::arg("mu_i"), py::arg("dphi"), py::arg("pool"), unlocked,
          "(f mu_i [light, view], albedo [view], specular reflectance [view]), see oriented_slices")
      .def("with_top_thickness", &OrientedSolution::with_top_thickness, py::arg("tau"), py::arg("pool"), unlocked)
      .def("diffuse_fluxes", &oriented_diffuse_fluxes, py::arg("side"), py::arg("pool"), unlocked);
  py::class_<SlicesBelowMedium>(module, "SlicesBelowMedium")
      .def(py::init([](const OrientedSolution& bare, const Eigen::VectorXd& mu_o, const Eigen::VectorXd& phi_o,
                       const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
             return std::make_unique<SlicesBelowMedium>(bare, OrientedGrid{mu_o, phi_o, mu_i, dphi}, pool);
           }),
           py::arg("bare"), py::arg("mu_o"), py::arg("phi_o"), py::arg("mu_i"), py::arg("dphi"), py::arg("pool"),
           py::keep_alive<1, 2>(), unlocked)
      .def(
          "of",
          [](const SlicesBelowMedium& below, const OrientedSolution& solution, ThreadPool& pool) {
            return parts_of(below.of(solution, pool));
          },
          py::arg("solution"), py::arg("pool"), unlocked, "As OrientedSolution.slices, of another thickness on top.");
  module.def(
      "solve_oriented",
      [](const Stack& stack, double tolerance, ThreadPool& pool) {
        return OrientedSolution(stack, tolerance, choose_oriented_resolution(stack, tolerance), pool);
      },
      py::arg("stack"), py::arg("tolerance"), py::arg("pool"), unlocked,
      "Solves a stack of isotropic or anisotropic facets with coupled azimuths.");
  module.def(
      "solve_oriented_at",
      [](const Stack& stack, double tolerance, int nodes, int orders, int fineness, ThreadPool& pool) {
        return OrientedSolution(stack, tolerance, {nodes, orders, fineness}, pool);
      },
      py::arg("stack"), py::arg("tolerance"), py::arg("nodes"), py::arg("orders"), py::arg("fineness"), py::arg("pool"),
      unlocked, "As solve_oriented, at a given resolution.");
}
