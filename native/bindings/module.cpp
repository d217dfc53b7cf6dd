// SPDX-License-Identifier: GPL-3.0-or-later
// The entry of the Python module lamina._core: checks the processor, then hands over to core_bindings.cpp.
#include <Python.h>

#include "processor.hpp"

extern "C" PyObject* PyInit_core_bindings();

PyMODINIT_FUNC PyInit__core() { return lamina::processor_suits() ? PyInit_core_bindings() : nullptr; }
