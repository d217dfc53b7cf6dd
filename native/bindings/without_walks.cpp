// SPDX-License-Identifier: GPL-3.0-or-later
// What takes the place of the walks and of the searchlight in the module of the demo's first picture.
#include <Python.h>

namespace lamina {
void bind_walk_parts(PyObject* module);
}  // namespace lamina

/// The package reads this number when it is imported.
void lamina::bind_walk_parts(PyObject* module) { PyModule_AddIntConstant(module, "WALK_BLOCK", 1); }
