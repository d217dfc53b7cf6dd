// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the solver, its solutions and their checks.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <algorithm>

#include "bindings.hpp"
#include "solve/evaluation.hpp"
#include "solve/sound_solution.hpp"
#include "table/slice_evaluation.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

py::array_t<double> shaped(std::vector<double> values, std::vector<py::ssize_t> shape) {
  auto* storage = new std::vector<double>(std::move(values));
  const py::capsule owner(storage, [](void* p) { delete static_cast<std::vector<double>*>(p); });
  return py::array_t<double>(std::move(shape), storage->data(), owner);
}

/// (values [sight, solution, view, light], lobes likewise, albedo [sight, solution, view], direct likewise), see
/// evaluate_slices. The lobes are None where no boundary is rough.
py::tuple slices(const std::vector<const Solution*>& solutions, const std::vector<std::pair<Side, Path>>& sights,
                 SliceGrid grid, ThreadPool& pool) {
  std::vector<Sight> wanted;
  for (const auto& [viewer, path] : sights) {
    wanted.push_back({viewer, path});
  }
  const auto tables = static_cast<py::ssize_t>(sights.size());
  const auto count = static_cast<py::ssize_t>(solutions.size());
  const py::ssize_t views = grid.view_mu.size();
  py::array_t<double> values({tables, count, views, static_cast<py::ssize_t>(grid.lights())});
  py::array_t<double> albedo({tables, count, views});
  py::array_t<double> direct({tables, count, views});
  const bool rough =
      std::any_of(solutions.begin(), solutions.end(), [](const Solution* s) { return !s->boundaries().empty(); });
  py::array_t<double> lobes({rough ? tables : 0, count, views, static_cast<py::ssize_t>(grid.lights())});
  const SliceSinks sinks{values.mutable_data(), rough ? lobes.mutable_data() : nullptr, albedo.mutable_data(),
                         direct.mutable_data()};
  {
    const py::gil_scoped_release release;
    evaluate_slices(solutions, wanted, grid, sinks, pool);
  }
  return py::make_tuple(values, rough ? py::object(lobes) : py::none(), albedo, direct);
}

/// `evaluate`, called without the interpreter's lock, as an array of `shape`.
template <typename Evaluate>
py::array_t<double> evaluated(std::vector<py::ssize_t> shape, const Evaluate& evaluate) {
  std::vector<double> values;
  {
    const py::gil_scoped_release release;
    values = evaluate();
  }
  return shaped(std::move(values), std::move(shape));
}

py::array_t<double> grid(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                         const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
  return evaluated({mu_o.size(), mu_i.size(), dphi.size()},
                   [&] { return evaluate_grid(solution, side, path, mu_o, mu_i, dphi, pool); });
}

py::array_t<double> points(const Solution& solution, Side side, Path path, const Eigen::VectorXd& mu_o,
                           const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi, ThreadPool& pool) {
  return evaluated({mu_o.size()}, [&] { return evaluate_points(solution, side, path, mu_o, mu_i, dphi, pool); });
}

void bind_results(py::module_& module) {
  py::class_<SolveChecks>(module, "SolveChecks")
      .def_readonly("quadrature", &SolveChecks::quadrature)
      .def_readonly("phase", &SolveChecks::phase)
      .def_readonly("energy", &SolveChecks::energy)
      .def_readonly("reciprocity", &SolveChecks::reciprocity)
      .def_readonly("negativity", &SolveChecks::negativity)
      .def_readonly("azimuth", &SolveChecks::azimuth)
      .def_readonly("resolution", &SolveChecks::resolution);
  py::class_<Fluxes>(module, "Fluxes")
      .def_readonly("reflected", &Fluxes::reflected)
      .def_readonly("mirrored", &Fluxes::mirrored)
      .def_readonly("transmitted", &Fluxes::transmitted)
      .def_readonly("direct", &Fluxes::direct);
}

void bind_solution(py::module_& module) {
  const auto unlocked = py::call_guard<py::gil_scoped_release>();
  py::class_<Solution>(module, "Solution")
      .def_property_readonly("nodes", [](const Solution& s) { return s.resolution().nodes; })
      .def_property_readonly("orders", &Solution::orders)
      .def_property_readonly(
          "node_cosines",
          [](const Solution& s) -> Eigen::VectorXd { return s.directions(Eigen::VectorXd()).front().mu; })
      .def_property_readonly(
          "node_weights",
          [](const Solution& s) -> Eigen::VectorXd { return s.directions(Eigen::VectorXd()).front().weight; })
      .def_property_readonly("checks", &Solution::checks)
      .def("with_reflectance", &Solution::with_reflectance, py::arg("reflectance"))
      .def("with_thickness", &lamina::with_thickness, py::arg("layer"), py::arg("tau"), py::arg("pool"), unlocked)
      .def("grid", &grid, py::arg("side"), py::arg("path"), py::arg("mu_o"), py::arg("mu_i"), py::arg("dphi"),
           py::arg("pool"))
      .def("points", &points, py::arg("side"), py::arg("path"), py::arg("mu_o"), py::arg("mu_i"), py::arg("dphi"),
           py::arg("pool"))
      .def("fluxes", &lamina::fluxes, py::arg("side"), py::arg("mu"), py::arg("pool"), unlocked)
      .def("diffuse_fluxes", &diffuse_fluxes, py::arg("side"), py::arg("pool"), unlocked);
  module.def(
      "slices",
      [](const std::vector<const Solution*>& solutions, const std::vector<std::pair<Side, Path>>& sights,
         const Eigen::VectorXd& mu_o, const Eigen::VectorXd& mu_i, const Eigen::VectorXd& dphi,
         ThreadPool& pool) { return slices(solutions, sights, SliceGrid{mu_o, mu_i, dphi}, pool); },
      py::arg("solutions"), py::arg("sights"), py::arg("mu_o"), py::arg("mu_i"), py::arg("dphi"), py::arg("pool"));
}

void bind_solves(py::module_& module) {
  const auto unlocked = py::call_guard<py::gil_scoped_release>();
  module.def("solve", &lamina::solve, py::arg("stack"), py::arg("tolerance"), py::arg("pool"), unlocked);
  module.def("solve_roughly", &lamina::solve_roughly, py::arg("stack"), py::arg("tolerance"), py::arg("nodes"),
             py::arg("pool"), unlocked);
  module.def("solve_mean", &lamina::solve_mean, py::arg("stack"), py::arg("tolerance"), py::arg("pool"), unlocked,
             "Solves the mean over azimuths alone: only fluxes can be asked.");
  module.def(
      "solve_at",
      [](const Stack& stack, int nodes, double azimuth_tolerance, ThreadPool& pool, double thinnest) {
        Resolution resolution;
        resolution.nodes = nodes;
        resolution.azimuth_tolerance = azimuth_tolerance;
        resolution.thinnest = thinnest;
        return lamina::solve_at(stack, resolution, pool);
      },
      py::arg("stack"), py::arg("nodes"), py::arg("azimuth_tolerance"), py::arg("pool"), py::arg("thinnest") = 1.0,
      unlocked, "Solves at a given resolution, without refinement; the checks give its accuracy.");
}

}  // namespace

void lamina::bind_solver(py::module_& module) {
  py::enum_<Side>(module, "Side").value("top", Side::kTop).value("bottom", Side::kBottom);
  py::enum_<Path>(module, "Path").value("reflect", Path::kReflect).value("transmit", Path::kTransmit);
  bind_results(module);
  bind_solution(module);
  bind_solves(module);
}
