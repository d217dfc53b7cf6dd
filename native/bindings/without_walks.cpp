// SPDX-License-Identifier: GPL-3.0-or-later
// Takes the place of the walks and the searchlight in a module built without them (LAMINA_WALKS=OFF).
#include <Python.h>

namespace lamina {
void bind_walk_parts(PyObject* module);
}  // namespace lamina

/// The package reads this number when it is imported.
void lamina::bind_walk_parts(PyObject* module) { PyModule_AddIntConstant(module, "WALK_BLOCK", 1); }
