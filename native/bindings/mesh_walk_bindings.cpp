// SPDX-License-Identifier: GPL-3.0-or-later
// Bindings of solids, coefficient grids and walks inside solids, in the module lamina._mesh.
#include <pybind11/stl.h>

#include <algorithm>

#include "mesh_bindings.hpp"
#include "mesh_walk/photon_walks.hpp"
#include "mesh_walk/point_walks.hpp"
#include "mesh_walk/walk_start.hpp"

namespace {

using namespace lamina;
using Voxels = py::array_t<std::uint16_t, py::array::c_style>;
using Triple = std::array<double, 3>;

Ray ray_of(const Triple& triple) { return {triple[0], triple[1], triple[2]}; }
Place place_of(const Triple& triple) { return {triple[0], triple[1], triple[2]}; }

/// Sets of linkings, and numbers of linkings, by triangle.
using LinkingSets = py::array_t<Occluders::LinkingSet, py::array::c_style>;
using Linkings = py::array_t<std::uint8_t, py::array::c_style>;
/// The members of Occluders::Links.
using BoundLinks = std::tuple<LinkingSets, LinkingSets, Linkings, Occluders::LinkingSet>;

Occluders::Links links_of(const BoundLinks& bound, py::ssize_t faces) {
  const auto& [shadows, lit, emits, solid_lit] = bound;
  const auto numbers = [faces](const auto& array) {
    if (array.ndim() != 1 || array.shape(0) != faces) {
      throw py::value_error("links must hold one value per triangle");
    }
    return std::vector(array.data(), array.data() + array.size());
  };
  Occluders::Links links{numbers(shadows), numbers(lit), numbers(emits), solid_lit};
  if (std::any_of(links.emits.begin(), links.emits.end(), [](auto one) { return one >= Occluders::kLinkings; })) {
    throw py::value_error("linkings must be below 64");
  }
  return links;
}

/// A lamp whose light has a linking.
Lamp linked(Lamp lamp, unsigned linking) {
  if (linking >= Occluders::kLinkings) {
    throw py::value_error("linking must be below 64");
  }
  lamp.link(linking);
  return lamp;
}

/// A solid, what stands around it, and the thread pool for its walks.
struct BoundSolid {
  ThreadPool pool;
  std::unique_ptr<Solid> solid;
  std::unique_ptr<Occluders> occluders;

  BoundSolid(const Floats& vertices, const Indices& triangles, unsigned threads, const py::function& go_on,
             std::vector<bool> opaque)
      : pool(threads) {
    TrianglePart part = part_of(vertices, triangles);
    if (part.triangles.empty()) {
      throw py::value_error("triangles must hold at least one");
    }
    if (!opaque.empty() && 3 * opaque.size() != part.triangles.size()) {
      throw py::value_error("opaque must be empty, or hold one value per triangle");
    }
    solid = built_on_a_thread<Solid>(
        go_on, [&](const auto& ask) { return std::make_unique<Solid>(std::move(part), std::move(opaque), pool, ask); });
  }

  void stand_among(const Floats& vertices, const Indices& triangles, const Floats& albedo, const Floats& emission,
                   const py::function& go_on, const std::optional<BoundLinks>& bound) {
    TrianglePart part = part_of(vertices, triangles);
    require_triples(albedo, "albedo");
    require_triples(emission, "emission");
    if (part.triangles.empty() || albedo.shape(0) != triangles.shape(0) || emission.shape(0) != triangles.shape(0)) {
      throw py::value_error("triangles, albedo and emission must have the same number of rows, at least one");
    }
    std::vector<Occluders::Face> values(static_cast<std::size_t>(albedo.shape(0)));
    for (std::size_t face = 0; face < values.size(); ++face) {
      std::copy_n(albedo.data() + kChannels * face, kChannels, values[face].albedo.begin());
      std::copy_n(emission.data() + kChannels * face, kChannels, values[face].emission.begin());
    }
    auto links = bound ? std::optional(links_of(*bound, albedo.shape(0))) : std::nullopt;
    occluders = built_on_a_thread<Occluders>(go_on, [&](const auto& ask) {
      return std::make_unique<Occluders>(std::move(part), std::move(values), std::move(links), solid->size(),
                                         pool.threads(), ask);
    });
  }

  MeshWalk walk(const CoefficientGrid& grid, const SurfaceBoundary& boundary) const {
    return {*solid, grid, boundary, occluders.get()};
  }
};

/// A grid and the array that holds its voxels.
struct BoundGrid {
  Voxels voxels;
  CoefficientGrid grid;
};

GridFrame frame_of(const Voxels& voxels, py::ssize_t axes, const Triple& low, const Triple& high, bool smooth) {
  if (voxels.ndim() != axes || voxels.size() == 0) {
    throw py::value_error("voxels must have the shape (nx, ny, nz), and for coefficients a last axis of 6");
  }
  GridFrame frame{{}, low, high, smooth};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    frame.voxels[axis] = static_cast<int>(voxels.shape(static_cast<py::ssize_t>(axis)));
    if (!(low[axis] < high[axis])) {
      throw py::value_error("low must be below high on each axis");
    }
  }
  return frame;
}

/// The result of work that touches no Python object, done while other Python threads may run.
template <class Work>
auto without_gil(const Work& work) {
  const py::gil_scoped_release release;
  return work();
}

BoundGrid grid_of_coefficients(const Voxels& voxels, const Triple& low, const Triple& high, bool smooth, float g) {
  const GridFrame frame = frame_of(voxels, 4, low, high, smooth);
  if (voxels.shape(3) != 6) {
    throw py::value_error("voxels must have a last axis of 6");
  }
  const auto* values = voxels.data();
  // Copying `voxels` counts a reference, for which the GIL is needed.
  return {voxels, without_gil([&] { return CoefficientGrid::of_halves(frame, values, g); })};
}

BoundGrid grid_of_mixture(const Voxels& voxels, const Triple& low, const Triple& high, bool smooth,
                          const std::vector<std::tuple<Channels, Channels, float>>& materials) {
  const GridFrame frame = frame_of(voxels, 3, low, high, smooth);
  if (materials.empty()) {
    throw py::value_error("palette must hold at least one material");
  }
  std::vector<EndMaterial> palette;
  for (const auto& [scattering, absorption, g] : materials) {
    palette.push_back({scattering, absorption, g});
  }
  const auto* values = voxels.data();
  return {voxels, without_gil([&] { return CoefficientGrid::of_mixture(frame, values, std::move(palette)); })};
}

/// Directions or positions, three numbers per row.
using Rows = py::array_t<double, py::array::c_style>;

Ray ray_at(const Rows& rows, std::size_t i) {
  const double* row = rows.data() + 3 * i;
  return {row[0], row[1], row[2]};
}

WalkPoints points_of(const Rows& positions, const Rows& normals, const std::optional<Rows>& views,
                     std::uint64_t first_number, std::uint64_t first_walk, std::uint64_t walks, std::uint64_t seed) {
  require_triples(positions, "positions");
  require_triples(normals, "normals");
  if (positions.shape(0) != normals.shape(0) || (views && views->shape(0) != positions.shape(0))) {
    throw py::value_error("positions, normals and views must have the same number of rows");
  }
  if (views) {
    require_triples(*views, "views");
  }
  WalkPoints points{{}, first_number, first_walk, walks, seed};
  for (std::size_t i = 0; i < static_cast<std::size_t>(positions.shape(0)); ++i) {
    const Ray place = ray_at(positions, i);
    MeshWalk::Start start{{place.x, place.y, place.z}, ray_at(normals, i), std::nullopt};
    if (views) {
      start.view = ray_at(*views, i);
    }
    points.starts.push_back(start);
  }
  return points;
}

py::array_t<std::int8_t> exposures(BoundSolid& solid, const Rows& positions, const Rows& normals) {
  const WalkPoints points = points_of(positions, normals, std::nullopt, 0, 0, 0, 0);
  py::array_t<std::int8_t> found(static_cast<py::ssize_t>(points.starts.size()));
  std::int8_t* out = found.mutable_data();
  const py::gil_scoped_release release;
  for (const MeshWalk::Start& start : points.starts) {
    *out++ = static_cast<std::int8_t>(exposure(*solid.solid, start.place, start.normal));
  }
  return found;
}

/// (mirrored, lost, scatterings, collisions, rays) of each point.
template <typename Results>
Rows counts_of(const Results& results) {
  Rows counts({static_cast<py::ssize_t>(results.size()), py::ssize_t{5}});
  double* out = counts.mutable_data();
  for (const auto& result : results) {
    *out++ = result.counts.mirrored;
    *out++ = result.counts.lost;
    *out++ = static_cast<double>(result.counts.scatterings);
    *out++ = static_cast<double>(result.counts.collisions);
    *out++ = static_cast<double>(result.counts.rays);
  }
  return counts;
}

py::tuple exits(BoundSolid& solid, const BoundGrid& grid, const SurfaceBoundary& boundary, const Rows& positions,
                const Rows& normals, const std::optional<Rows>& views, std::uint64_t first_number,
                std::uint64_t first_walk, std::uint64_t walks, std::uint64_t seed, const LateAfter& late_after) {
  const WalkPoints points = points_of(positions, normals, views, first_number, first_walk, walks, seed);
  const auto results = [&] {
    const py::gil_scoped_release release;
    return walk_to_exits(solid.walk(grid.grid, boundary), points, solid.pool, late_after);
  }();
  const auto count = static_cast<py::ssize_t>(results.size());
  Rows moments({count, py::ssize_t{3}, py::ssize_t{3}});
  Rows products({count, py::ssize_t{3}, py::ssize_t{6}});
  Rows lates({count, py::ssize_t{3}, py::ssize_t{2}});
  double* moment = moments.mutable_data();
  double* product = products.mutable_data();
  double* late = lates.mutable_data();
  for (const ExitResult& result : results) {
    for (const ExitSums::OfChannel& channel : result.exits.channels) {
      moment = std::copy(channel.moments.begin(), channel.moments.end(), moment);
      product = std::copy(channel.products.begin(), channel.products.end(), product);
      late = std::copy(channel.late.begin(), channel.late.end(), late);
    }
  }
  return py::make_tuple(moments, products, counts_of(results), lates);
}

/// Numbers of LightMoments.
constexpr py::ssize_t kNumbers = std::tuple_size_v<LightMoments>;

py::tuple light(BoundSolid& solid, const BoundGrid& grid, const SurfaceBoundary& boundary, const Rows& positions,
                const Rows& normals, const std::optional<Rows>& views, std::uint64_t first_number,
                std::uint64_t first_walk, std::uint64_t walks, std::uint64_t seed, const std::vector<Lamp>& lamps,
                bool by_occluders, const Surroundings& surroundings) {
  const WalkPoints points = points_of(positions, normals, views, first_number, first_walk, walks, seed);
  const auto results = [&] {
    const py::gil_scoped_release release;
    return walk_to_lights(solid.walk(grid.grid, boundary), points, lamps, by_occluders, surroundings, solid.pool);
  }();
  const auto count = static_cast<py::ssize_t>(results.size());
  const auto columns = static_cast<py::ssize_t>(lamps.size() + 1);
  Rows sums({count, columns, kNumbers});
  Rows squares({count, columns, kNumbers});
  double* sum = sums.mutable_data();
  double* square = squares.mutable_data();
  for (const LitResult& result : results) {
    for (std::size_t k = 0; k < result.light.sums.size(); ++k) {
      sum = std::copy(result.light.sums[k].begin(), result.light.sums[k].end(), sum);
      square = std::copy(result.light.squares[k].begin(), result.light.squares[k].end(), square);
    }
  }
  return py::make_tuple(sums, squares, counts_of(results));
}

/// Numbers of positions by texel.
using Numbers = py::array_t<std::int32_t, py::array::c_style>;

std::unique_ptr<SurfaceTexels> surface_texels(const BoundSolid& solid, const Rows& uvs, const Numbers& numbers,
                                              const Rows& positions, const Rows& normals) {
  const auto faces = static_cast<py::ssize_t>(solid.solid->faces());
  if (uvs.ndim() != 3 || uvs.shape(0) != faces || uvs.shape(1) != 3 || uvs.shape(2) != 2) {
    throw py::value_error("uvs must have the shape (faces, 3, 2)");
  }
  if (numbers.ndim() != 2) {
    throw py::value_error("numbers must have the shape (height, width)");
  }
  TexelImage image{static_cast<std::int32_t>(numbers.shape(1)),
                   static_cast<std::int32_t>(numbers.shape(0)),
                   {uvs.data(), uvs.data() + uvs.size()},
                   {numbers.data(), numbers.data() + numbers.size()}};
  std::vector<MeshWalk::Start> starts = points_of(positions, normals, std::nullopt, 0, 0, 0, 0).starts;
  const auto count = static_cast<std::int32_t>(starts.size());
  if (std::any_of(image.points.begin(), image.points.end(), [&](std::int32_t one) { return one >= count; })) {
    throw py::value_error("numbers must be below the number of positions");
  }
  const py::gil_scoped_release release;
  return std::make_unique<SurfaceTexels>(*solid.solid, std::move(image), std::move(starts));
}

py::tuple photons(BoundSolid& solid, const BoundGrid& grid, const SurfaceBoundary& boundary, const PhotonSource& source,
                  const SurfaceTexels& texels, std::uint64_t first, std::uint64_t count, std::uint64_t seed) {
  const PhotonSums found = without_gil([&] {
    return photons_to_texels(solid.walk(grid.grid, boundary), source, texels, {first, count, seed}, solid.pool);
  });
  const auto points = static_cast<py::ssize_t>(found.sums.size());
  Rows sums({points, kNumbers});
  Rows squares({points, kNumbers});
  double* sum = sums.mutable_data();
  double* square = squares.mutable_data();
  for (std::size_t k = 0; k < found.sums.size(); ++k) {
    sum = std::copy(found.sums[k].begin(), found.sums[k].end(), sum);
    square = std::copy(found.squares[k].begin(), found.squares[k].end(), square);
  }
  return py::make_tuple(sums, squares, counts_of(std::vector{found}));
}

}  // namespace

void lamina::bind_mesh_walk(py::module_& module) {
  py::class_<BoundSolid>(module, "Solid", "A closed mesh, lengths in mm, and the threads that walk in it.")
      .def(py::init<const Floats&, const Indices&, unsigned, const py::function&, std::vector<bool>>(),
           py::arg("vertices"), py::arg("triangles"), py::arg("threads"), py::arg("go_on"),
           py::arg("opaque") = std::vector<bool>())
      .def(
          "clearance",
          [](const BoundSolid& self, const Triple& place) {
            return self.solid->clearance({place[0], place[1], place[2]});
          },
          py::arg("place"), "A distance in mm up to which there is no surface around a place.")
      .def(
          "distances",
          [](const BoundSolid& self, const Floats& positions, float within) {
            require_triples(positions, "positions");
            Floats found(positions.shape(0));
            for (py::ssize_t i = 0; i < positions.shape(0); ++i) {
              found.mutable_data()[i] = self.solid->distance(positions.data() + 3 * i, within);
            }
            return found;
          },
          py::arg("positions").noconvert(), py::arg("within"),
          "Distances in mm from places to the surface, `within` where that is farther.")
      .def("exposures", &exposures, py::arg("positions"), py::arg("normals"),
           "Of each start of walks: 0 where light can enter, 1 inside another part of the mesh, 2 where the normal "
           "points inwards, 3 on an opaque face.")
      .def("stand_among", &BoundSolid::stand_among, py::arg("vertices"), py::arg("triangles"), py::arg("albedo"),
           py::arg("emission"), py::arg("go_on"), py::arg("links") = std::nullopt,
           "Put opaque things around the solid, with the albedo and the emitted radiance of each triangle. `links`: "
           "(the linkings whose light each triangle takes, as bits, those that light it, the linking of what it "
           "emits, the linkings that light the solid); without them all light meets everything.")
      .def_property_readonly("bytes", [](const BoundSolid& self) { return self.solid->bytes(); });
  py::class_<BoundGrid>(module, "Grid", "Coefficients in voxels [x, y, z] of a box in mm.")
      .def_static("of_coefficients", &grid_of_coefficients, py::arg("voxels").noconvert(), py::arg("low"),
                  py::arg("high"), py::arg("smooth"), py::arg("g"),
                  "Voxels are six halves, as bits: sigma_s and sigma_a of three channels, in 1/mm.")
      .def_static("of_mixture", &grid_of_mixture, py::arg("voxels").noconvert(), py::arg("low"), py::arg("high"),
                  py::arg("smooth"), py::arg("palette"),
                  "Voxels are places in the palette, 0 to 65535; the palette is a list of (sigma_s, sigma_a, g).");
  py::class_<SurfaceBoundary>(module, "Boundary", "The boundary of a solid in air.")
      .def(py::init([](double ior, double alpha, const std::string& distribution) {
             Facets facets;
             facets.alpha = alpha;
             facets.distribution =
                 distribution == "beckmann" ? Facets::Distribution::kBeckmann : Facets::Distribution::kGgx;
             return SurfaceBoundary(ior, alpha > 0.0 ? &facets : nullptr);
           }),
           py::arg("ior"), py::arg("alpha"), py::arg("distribution"));
  py::class_<Lamp>(module, "Lamp", "A lamp of unit strength, lengths in mm.")
      .def_static(
          "distant", [](const Triple& towards, double cosine) { return Lamp::distant(ray_of(towards), cosine); },
          py::arg("towards"), py::arg("cosine"))
      .def_static(
          "sphere", [](const Triple& centre, double radius) { return Lamp::sphere(place_of(centre), radius); },
          py::arg("centre"), py::arg("radius"))
      .def_static(
          "spot",
          [](const Triple& centre, double radius, const Triple& axis, double cosine, double blend) {
            return Lamp::spot(place_of(centre), radius, ray_of(axis), cosine, blend);
          },
          py::arg("centre"), py::arg("radius"), py::arg("axis"), py::arg("cosine"), py::arg("blend"))
      .def_static(
          "area",
          [](const Triple& centre, const Triple& first, const Triple& second, bool ellipse) {
            return Lamp::area(place_of(centre), ray_of(first), ray_of(second), ellipse);
          },
          py::arg("centre"), py::arg("first"), py::arg("second"), py::arg("ellipse"))
      .def("linked", &linked, py::arg("linking"), "The lamp with light of this linking, 0 to 63.");
  py::class_<Surroundings>(module, "Surroundings", "Radiance by direction; without a table, 1 everywhere.")
      .def(py::init<>())
      .def(py::init([](const Floats& table) {
             if (table.ndim() != 3 || table.shape(2) != 3) {
               throw std::invalid_argument("table must be (rows, columns, 3)");
             }
             return Surroundings(static_cast<std::size_t>(table.shape(0)), static_cast<std::size_t>(table.shape(1)),
                                 {table.data(), table.data() + table.size()});
           }),
           py::arg("table").noconvert());
  module.def("walk_to_exits", &exits, py::arg("solid"), py::arg("grid"), py::arg("boundary"), py::arg("positions"),
             py::arg("normals"), py::arg("views"), py::arg("first_number"), py::arg("first_walk"), py::arg("walks"),
             py::arg("seed"), py::arg("late_after"),
             "(moments [point, channel, (w, w r, w r^2)], products [point, channel, 6], counts [point, (mirrored, "
             "lost, scatterings, collisions, rays)], late [point, channel, (w, w r)] of paths with more scatterings "
             "than `late_after` of their channel).");
  module.def("walk_to_lights", &light, py::arg("solid"), py::arg("grid"), py::arg("boundary"), py::arg("positions"),
             py::arg("normals"), py::arg("views"), py::arg("first_number"), py::arg("first_walk"), py::arg("walks"),
             py::arg("seed"), py::arg("lamps"), py::arg("by_occluders"), py::arg("surroundings"),
             "(sums [point, lamp or last the surroundings, (channels, moments)], squares, counts).");
  py::class_<PhotonSource>(module, "PhotonSource", "Where the light of a lamp meets a solid.")
      .def(py::init([](BoundSolid& solid, const Lamp& lamp, const BoundGrid& grid, const SurfaceBoundary& boundary) {
             return without_gil([&] {
               const MeshWalk walk = solid.walk(grid.grid, boundary);
               return PhotonSource(walk, *solid.solid, lamp, solid.occluders.get(), solid.pool);
             });
           }),
           py::arg("solid"), py::arg("lamp"), py::arg("grid"), py::arg("boundary"), py::keep_alive<1, 2>());
  py::class_<SurfaceTexels>(module, "SurfaceTexels", "The parts of a surface below the texels of an image.")
      .def(py::init(&surface_texels), py::arg("solid"), py::arg("uvs"), py::arg("numbers"), py::arg("positions"),
           py::arg("normals"), py::keep_alive<1, 2>(),
           "`numbers`: of each texel's position, -1 without one, rows from the bottom.")
      .def_property_readonly("areas", [](const SurfaceTexels& self) { return self.areas(); }, "In mm^2, by position.");
  module.def("photons_to_texels", &photons, py::arg("solid"), py::arg("grid"), py::arg("boundary"), py::arg("source"),
             py::arg("texels"), py::arg("first"), py::arg("count"), py::arg("seed"),
             "(sums [position, (channels, moments)], squares, counts [1, 5]) of samples [first, first + count).");
}
