// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the searchlight.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "lateral/searchlight.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

/// Evaluates a function of a distance or a frequency at a list of them.
template <double (LeavingLight::*Function)(double) const>
py::array_t<double> evaluated(const LeavingLight& light, const py::array_t<double>& places, ThreadPool& pool) {
  py::array_t<double> values(places.size());
  const double* from = places.data();
  double* to = values.mutable_data();
  const auto count = static_cast<std::size_t>(places.size());
  {
    const py::gil_scoped_release release;
    pool.run(count, [&](std::size_t k) { to[k] = (light.*Function)(from[k]); });
  }
  return values;
}

}  // namespace

void lamina::bind_lateral(py::module_& module) {
  const auto unlocked = py::call_guard<py::gil_scoped_release>();
  py::class_<MeasuredStack>(module, "MeasuredStack")
      .def(py::init([](const Stack& stack, std::vector<double> extinction, std::vector<double> thickness,
                       std::vector<double> whole_tau) {
             return MeasuredStack{stack, std::move(extinction), std::move(thickness), std::move(whole_tau)};
           }),
           py::arg("stack"), py::arg("extinction"), py::arg("thickness"), py::arg("whole_tau"),
           "A stack of homogeneous layers with, by layer, extinction (1/mm) and thickness (mm). whole_tau: the optical "
           "thickness of the medium, and for slices of a graded medium that of the whole.");

  py::class_<LeavingLight>(module, "LeavingLight")
      .def_readonly("flux", &LeavingLight::flux)
      .def_readonly("at_entry", &LeavingLight::at_entry)
      .def_readonly("direct", &LeavingLight::direct)
      .def_readonly("distance", &LeavingLight::distance)
      .def_readonly("square_distance", &LeavingLight::square_distance)
      .def("at", &evaluated<&LeavingLight::at>, py::arg("q"), py::arg("pool"))
      .def("inside", &evaluated<&LeavingLight::inside>, py::arg("r"), py::arg("pool"))
      .def("density", &evaluated<&LeavingLight::density>, py::arg("r"), py::arg("pool"));

  py::class_<Searchlight>(module, "Searchlight")
      .def(py::init([](const MeasuredStack& stack, double mu, bool preview) {
             return Searchlight(stack, mu, preview ? SearchlightQuality::preview() : SearchlightQuality{});
           }),
           py::arg("stack"), py::arg("mu"), py::arg("preview"))
      .def_property_readonly("done", &Searchlight::done)
      .def_property_readonly("progress", &Searchlight::progress)
      .def_property_readonly("nodes", &Searchlight::nodes)
      .def_property_readonly("frequencies", &Searchlight::frequencies)
      .def("advance", &Searchlight::advance, py::arg("pool"), unlocked)
      .def_property_readonly("reflected", &Searchlight::reflected, py::return_value_policy::reference_internal)
      .def_property_readonly("transmitted", &Searchlight::transmitted, py::return_value_policy::reference_internal);

  module.def(
      "lateral_flux",
      [](const MeasuredStack& stack, double mu, double q, int nodes, int azimuths, double bend, ThreadPool& pool) {
        const LateralStack lateral(stack, LateralResolution{nodes, azimuths, bend}, mu, pool);
        const LateralFlux flux =
            lateral.at(q, azimuths == 1 ? AzimuthRule::mean() : AzimuthRule(azimuths, bend, azimuths));
        return std::pair(flux.reflected, flux.transmitted);
      },
      py::arg("stack"), py::arg("mu"), py::arg("q"), py::arg("nodes"), py::arg("azimuths"), py::arg("bend"),
      py::arg("pool"), unlocked,
      "(reflected, transmitted) at one lateral frequency and a given resolution; truncated peaks count as "
      "unscattered.");
}
