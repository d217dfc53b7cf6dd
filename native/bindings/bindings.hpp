// SPDX-License-Identifier: GPL-3.0-or-later
// Each function binds one part of the core to the Python module.
#pragma once
#include <pybind11/pybind11.h>

#include <string>

#include "phase/phase.hpp"

namespace lamina {

void bind_threads(pybind11::module_& module);
void bind_phase(pybind11::module_& module);
void bind_stack(pybind11::module_& module);
void bind_solver(pybind11::module_& module);
void bind_oriented(pybind11::module_& module);
void bind_fit(pybind11::module_& module);
/// The five below together; nothing in the module of the demo's first picture, which is built without them.
void bind_walk_parts(PyObject* module);
void bind_walks(pybind11::module_& module);
void bind_scattering(pybind11::module_& module);
void bind_lateral(pybind11::module_& module);
void bind_lateral_walks(pybind11::module_& module);
void bind_maps(pybind11::module_& module);

/// A phase function from its kind and that kind's parameters. Throws ValueError for an unknown kind and TypeError for
/// a wrong number of parameters.
PhaseFunction make_phase(const std::string& kind, const pybind11::tuple& parameters);

}  // namespace lamina
