// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the thread pool.
#include "bindings.hpp"
#include "numeric/thread_pool.hpp"

namespace py = pybind11;

void lamina::bind_threads(py::module_& module) {
  py::class_<ThreadPool>(module, "ThreadPool", "Threads for the core's calls; 0: one per hardware thread.")
      .def(py::init<unsigned>(), py::arg("threads") = 0)
      .def_property_readonly("threads", &ThreadPool::threads)
      .def("stop", &ThreadPool::stop, "From another thread: ends the work on these threads for good.");
}
