// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module lamina._mesh: dust and texels on meshes, walks inside meshes. This module is separate from _core,
// so that the rest of the package works without Embree.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>

#include "dust/corner_split.hpp"
#include "dust/dust.hpp"
#include "dust/texel_raster.hpp"
#include "mesh_bindings.hpp"
#include "processor.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;
using Doubles = py::array_t<double, py::array::c_style>;

struct BoundFall : Fall {
  OpenShare open;
  explicit BoundFall(const Fall& fall) : Fall(fall), open(fall) {}
};

/// A scene and the thread pool that traces it.
class Scene {
 public:
  Scene(const std::vector<std::pair<Floats, Indices>>& meshes, unsigned threads, const py::function& go_on)
      : pool_(threads) {
    std::vector<TrianglePart> parts;
    for (const auto& [vertices, triangles] : meshes) {
      parts.push_back(part_of(vertices, triangles));
    }
    scene_ = built_on_a_thread<MeshScene>(
        go_on, [&](const auto& ask) { return std::make_unique<MeshScene>(std::move(parts), pool_.threads(), ask); });
  }

  py::tuple arrivals(const BoundFall& fall, const Floats& positions, const Floats& normals, std::uint64_t first_number,
                     const ArrivalOptions& options) {
    const PointSet points = points_of(positions, normals, first_number, options);
    Floats shares(options.two_sided ? std::vector<py::ssize_t>{positions.shape(0), 2}
                                    : std::vector<py::ssize_t>{positions.shape(0)});
    std::uint64_t rays = 0;
    {
      float* out = shares.mutable_data();
      const py::gil_scoped_release release;
      rays = dust_arrivals(*scene_, fall, fall.open, points, options, out, pool_);
    }
    return py::make_tuple(shares, rays);
  }

  py::tuple exposures(const Floats& positions, const Floats& normals, std::uint64_t first_number,
                      const ArrivalOptions& options, float reach) {
    return around(dust_exposures, points_of(positions, normals, first_number, options), options, reach);
  }

  py::tuple convexities(const Floats& positions, const Floats& normals, std::uint64_t first_number,
                        const ArrivalOptions& options, float reach) {
    return around(dust_convexities, points_of(positions, normals, first_number, options), options, reach);
  }

  py::tuple grains(const BoundFall& fall, const Vec3f& corner, const Vec3f& edge1, const Vec3f& edge2,
                   std::uint64_t count, std::uint64_t seed) {
    GrainCount counted;
    {
      const py::gil_scoped_release release;
      counted = trace_grains(*scene_, fall, {corner, edge1, edge2}, count, seed, pool_);
    }
    return py::make_tuple(counted.front, counted.back, counted.stopped, counted.missed);
  }

  std::size_t bytes() const { return scene_->bytes(); }

 private:
  /// (values, rays traced) of a function of the rays around points.
  py::tuple around(decltype(dust_exposures)& measure, const PointSet& points, const ArrivalOptions& options,
                   float reach) {
    Floats values(static_cast<py::ssize_t>(points.count));
    std::uint64_t rays = 0;
    {
      float* out = values.mutable_data();
      const py::gil_scoped_release release;
      rays = measure(*scene_, points, options, reach, out, pool_);
    }
    return py::make_tuple(values, rays);
  }

  static PointSet points_of(const Floats& positions, const Floats& normals, std::uint64_t first_number,
                            const ArrivalOptions& options) {
    require_triples(positions, "positions");
    require_triples(normals, "normals");
    if (positions.shape(0) != normals.shape(0)) {
      throw py::value_error("positions and normals must have the same number of rows");
    }
    if (options.rays < 1) {
      throw py::value_error("rays must be at least 1");
    }
    return {positions.data(), normals.data(), static_cast<std::size_t>(positions.shape(0)), first_number};
  }

  ThreadPool pool_;
  std::unique_ptr<MeshScene> scene_;
};

py::tuple texels(const Doubles& uvs, int width, int height, int first_row, std::optional<int> rows) {
  if (uvs.ndim() != 3 || uvs.shape(1) != 3 || uvs.shape(2) != 2 || width < 1 || height < 1) {
    throw py::value_error("uvs must have shape (m, 3, 2), and the image at least one texel");
  }
  const TexelRows image{width, height, first_row, rows.value_or(height)};
  if (first_row < 0 || image.rows < 0 || image.rows > height - first_row) {
    throw py::value_error("first_row and rows must lie within the image");
  }
  py::array_t<std::int32_t> triangle({image.rows, width});
  Floats weights({image.rows, width, 2});
  raster_texels(uvs.data(), static_cast<std::size_t>(uvs.shape(0)), image, triangle.mutable_data(),
                weights.mutable_data());
  return py::make_tuple(triangle, weights);
}

template <typename T>
py::array_t<T> array_of(const std::vector<T>& values) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::tuple corner_points(const Indices& triangles, const Floats& normals, float cosine, std::uint32_t vertices) {
  require_triples(triangles, "triangles");
  require_triples(normals, "normals");
  for (py::ssize_t i = 0; i < triangles.size(); ++i) {
    if (triangles.data()[i] >= vertices) {
      throw py::value_error("triangles must hold indices below the number of vertices");
    }
  }
  const py::ssize_t count = triangles.shape(0);
  const TriangleList list{triangles.data(), static_cast<std::size_t>(count), vertices};
  if (normals.shape(0) != count && normals.shape(0) != 3 * count) {
    throw py::value_error("normals must have a row for each triangle, or for each corner");
  }
  const float* data = normals.data();
  CornerPoints found;
  {
    const py::gil_scoped_release release;
    found = normals.size() == 3 * count ? smooth_corners(list, data, cosine) : distinct_corners(list, data, cosine);
  }
  return py::make_tuple(array_of(found.point).reshape({count, py::ssize_t{3}}), array_of(found.vertex),
                        array_of(found.first));
}

}  // namespace

PYBIND11_MODULE(_mesh, module) {
  if (!processor_suits()) {
    throw py::error_already_set();
  }
  const std::string wrong = mesh_self_test();
  if (!wrong.empty()) {
    throw py::import_error(wrong);
  }
  py::class_<BoundFall>(module, "Fall",
                        "How grains fall: orthonormal directions, and the wind relative to the speed of the fall.")
      .def(py::init([](const Vec3f& up, const Vec3f& across1, const Vec3f& across2, float wind1, float wind2,
                       float sin_spread) {
             if (!(sin_spread >= 0.0F && sin_spread < 1.0F)) {
               throw py::value_error("sin_spread must lie in [0, 1)");
             }
             return BoundFall(Fall{up, across1, across2, wind1, wind2, sin_spread});
           }),
           py::arg("up"), py::arg("across1"), py::arg("across2"), py::arg("wind1"), py::arg("wind2"),
           py::arg("sin_spread"))
      .def("open_share", [](const BoundFall& fall, double up, double across1, double across2) {
        return fall.open(up, across1, across2);
      });
  py::class_<ArrivalOptions>(module, "Options")
      .def(py::init<int, std::uint64_t, bool, float>(), py::arg("rays"), py::arg("seed"), py::arg("two_sided"),
           py::arg("offset"));
  py::class_<Scene>(module, "Scene", "Meshes (vertices, triangles); dust settles on the first.")
      .def(py::init<const std::vector<std::pair<Floats, Indices>>&, unsigned, const py::function&>(), py::arg("meshes"),
           py::arg("threads"), py::arg("go_on"))
      .def("arrivals", &Scene::arrivals, py::arg("fall"), py::arg("positions").noconvert(),
           py::arg("normals").noconvert(), py::arg("first_number"), py::arg("options"),
           "(shares, rays traced); one share per point, or front and back")
      .def("exposures", &Scene::exposures, py::arg("positions").noconvert(), py::arg("normals").noconvert(),
           py::arg("first_number"), py::arg("options"), py::arg("reach"), "(exposures, rays traced)")
      .def("convexities", &Scene::convexities, py::arg("positions").noconvert(), py::arg("normals").noconvert(),
           py::arg("first_number"), py::arg("options"), py::arg("reach"), "(convexities, rays traced)")
      .def("grains", &Scene::grains, py::arg("fall"), py::arg("corner"), py::arg("edge1"), py::arg("edge2"),
           py::arg("count"), py::arg("seed"), "Counts of grains: (front, back, stopped by each mesh, missed)")
      .def_property_readonly("bytes", &Scene::bytes);
  module.def("texels", &texels, py::arg("uvs"), py::arg("width"), py::arg("height"), py::arg("first_row") = 0,
             py::arg("rows") = py::none(), "(triangle, weights of corners 2 and 3) of each texel in the rows.");
  module.def(
      "corner_points", &corner_points, py::arg("triangles"), py::arg("normals"), py::arg("cosine"), py::arg("vertices"),
      "(point of each corner, vertex of each point, first corner of each point). The corners at a vertex share a "
      "point across edges where the cosine between the triangles' normals, or with three normals per triangle "
      "between the corners' own normals, is at least `cosine`.");
  bind_mesh_walk(module);
}
