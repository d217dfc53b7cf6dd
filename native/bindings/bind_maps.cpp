// SPDX-License-Identifier: GPL-3.0-or-later
// Binds windows around the points of a map.
#include <pybind11/numpy.h>

#include <algorithm>
#include <cstdint>

#include "bindings.hpp"
#include "maps/nearest_vertices.hpp"
#include "maps/window.hpp"
#include "numeric/thread_pool.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;
using Doubles = py::array_t<double, py::array::c_style>;
using Singles = py::array_t<float, py::array::c_style>;
using Numbers = py::array_t<std::int32_t, py::array::c_style>;

void require_that(bool holds, const char* message) {
  if (!holds) {
    throw py::value_error(message);
  }
}

void require_below(const Numbers& numbers, py::ssize_t points) {
  const std::int32_t* const data = numbers.data();
  for (py::ssize_t k = 0; k < numbers.size(); ++k) {
    require_that(data[k] < points, "numbers must be below the number of points");
  }
}

/// A window and the arrays that hold it.
struct BoundWindow {
  Numbers numbers;
  Singles weights;
  Singles places;
  Window window;

  BoundWindow(Numbers given, Singles weights_given, Singles places_given)
      : numbers(std::move(given)), weights(std::move(weights_given)), places(std::move(places_given)) {
    require_that(numbers.ndim() == 2, "numbers must have the shape (neighbours, points)");
    const bool is_uniform = weights.ndim() == 1;
    const py::ssize_t members = is_uniform ? numbers.shape(0) : numbers.size();
    require_that(weights.size() == members && weights.shape(0) == numbers.shape(0) && places.size() == 2 * members,
                 "weights and places must have one row per neighbour, or one per neighbour and point");
    require_below(numbers, numbers.shape(1));
    window = {static_cast<std::size_t>(numbers.shape(1)),
              static_cast<std::size_t>(numbers.shape(0)),
              numbers.data(),
              weights.data(),
              places.data(),
              is_uniform};
  }

  PointValues of(const Doubles& values) const {
    require_that(values.ndim() == 2 && values.shape(0) == numbers.shape(1), "values must have the shape (points, n)");
    return {values.data(), static_cast<std::size_t>(values.shape(1))};
  }

  Doubles mean(const Doubles& values, ThreadPool& pool) const {
    const PointValues given = of(values);
    Doubles found({values.shape(0), values.shape(1)});
    double* const out = found.mutable_data();
    const py::gil_scoped_release release;
    window_mean(window, given, out, pool);
    return found;
  }

  std::pair<Doubles, Doubles> regression(const Doubles& guides, const Doubles& values, double ridge,
                                         ThreadPool& pool) const {
    const PointValues given = of(values);
    const PointValues by = of(guides);
    require_that(by.columns <= kMostGuides, "guides must have at most five columns");
    Doubles fit({values.shape(0), values.shape(1)});
    Doubles leverage(values.shape(0));
    double* const out = fit.mutable_data();
    double* const own = leverage.mutable_data();
    {
      const py::gil_scoped_release release;
      window_regression(window, by, given, ridge, out, own, pool);
    }
    return {fit, leverage};
  }
};

Numbers nearest(const Doubles& positions, const Numbers& along, py::ssize_t most, ThreadPool& pool) {
  require_that(positions.ndim() == 2 && positions.shape(1) == 3 && along.ndim() == 2 &&
                   along.shape(0) == positions.shape(0) && most >= 1,
               "positions must have the shape (n, 3), along (n, m), and most be at least 1");
  require_below(along, along.shape(0));
  require_that(std::all_of(along.data(), along.data() + along.size(), [](auto vertex) { return vertex >= 0; }),
               "along must not be negative");
  Numbers found({along.shape(0), most});
  std::int32_t* const out = found.mutable_data();
  const py::gil_scoped_release release;
  nearest_vertices(positions.data(), along.data(), static_cast<std::size_t>(along.shape(0)),
                   static_cast<std::size_t>(along.shape(1)), static_cast<std::size_t>(most), out, pool);
  return found;
}

}  // namespace

void lamina::bind_maps(py::module_& module) {
  py::class_<BoundWindow>(module, "Window", "The weighted neighbours of the points of a map.")
      .def(py::init<Numbers, Singles, Singles>(), py::arg("numbers"), py::arg("weights"), py::arg("places"),
           "numbers [neighbour, point], below 0 where there is none; weights [neighbour, point] and places along two "
           "tangents [neighbour, point, 2], or without the axis of points if they are the same for all")
      .def("mean", &BoundWindow::mean, py::arg("values"), py::arg("pool"),
           "The weighted mean of values [point, n] over the window of each point.")
      .def("regression", &BoundWindow::regression, py::arg("guides"), py::arg("values"), py::arg("ridge"),
           py::arg("pool"), "(fit [point, n], share [point] of the own value in it), see window_regression");
  module.def("nearest_vertices", &nearest, py::arg("positions"), py::arg("along"), py::arg("most"), py::arg("pool"),
             "The nearest of the neighbours `along` [vertex, m] and of their neighbours: numbers [vertex, most].");
}
