// SPDX-License-Identifier: GPL-3.0-or-later
// Declarations shared by the source files of the Python module lamina._mesh.
#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "mesh/mesh_scene.hpp"

namespace lamina {

namespace py = pybind11;

using Floats = py::array_t<float, py::array::c_style>;
using Indices = py::array_t<std::uint32_t, py::array::c_style>;

void bind_mesh_walk(py::module_& module);

inline void require_triples(const py::array& array, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != 3) {
    throw py::value_error(std::string(name) + " must have shape (n, 3)");
  }
}

inline TrianglePart part_of(const Floats& vertices, const Indices& triangles) {
  require_triples(vertices, "vertices");
  require_triples(triangles, "triangles");
  TrianglePart part{{vertices.data(), vertices.data() + vertices.size()},
                    {triangles.data(), triangles.data() + triangles.size()}};
  const auto count = static_cast<std::size_t>(vertices.shape(0));
  for (const std::uint32_t index : part.triangles) {
    if (index >= count) {
      throw py::value_error("triangles must hold indices below the number of vertices");
    }
  }
  return part;
}

/// Runs `make(ask)` on another thread and returns the result. Meanwhile the calling thread asks Python whether to
/// continue; `ask(fraction)` reports the progress. Rethrows an exception of `go_on`; returns null if the work stops
/// without one.
template <typename Built, typename Make>
std::unique_ptr<Built> built_on_a_thread(const py::function& go_on, const Make& make) {
  std::atomic<double> fraction = 0.0;
  std::atomic<bool> stop = false;
  std::optional<py::error_already_set> raised;
  auto built = std::async(std::launch::async, [&] {
    return make([&](double done) {
      fraction = done;
      return !stop;
    });
  });
  {
    const py::gil_scoped_release release;
    while (built.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
      const py::gil_scoped_acquire acquire;
      try {
        if (!stop) {
          go_on(fraction.load());
        }
      } catch (py::error_already_set& error) {
        raised = error;
        stop = true;
      }
    }
  }
  std::unique_ptr<Built> result;
  try {
    result = built.get();
  } catch (const MeshScene::Stopped&) {
  }
  if (raised) {
    throw py::error_already_set(*raised);
  }
  return result;
}

}  // namespace lamina
