// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <pybind11/pybind11.h>

namespace lamina {

void bind_threads(pybind11::module_& module);
void bind_solver(pybind11::module_& module);
void bind_fit(pybind11::module_& module);

}  // namespace lamina
