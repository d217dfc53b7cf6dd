// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the fit of closures to slices.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "bindings.hpp"
#include "fit/closure_fit.hpp"
#include "fit/moving_fit.hpp"
#include "fit/oriented_lobe.hpp"
#include "numeric/thread_pool.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

void require(bool holds, const char* message) {
  if (!holds) {
    throw py::value_error(message);
  }
}

/// The closures of a dictionary on the light grid, for every view column, with their inner products.
class ClosureTable {
 public:
  /// `values` [column, closure, light], `solid_angle` [light], `albedo` [column, closure].
  ClosureTable(const Array& values, Eigen::VectorXd solid_angle, const Array& albedo)
      : solid_angle_(std::move(solid_angle)) {
    require(values.ndim() == 3 && albedo.ndim() == 2, "values must have 3 axes, albedo 2");
    const Eigen::Index closures = values.shape(1);
    const Eigen::Index lights = values.shape(2);
    require(lights == solid_angle_.size(), "values and solid_angle disagree on the light grid");
    for (py::ssize_t column = 0; column < values.shape(0); ++column) {
      values_.emplace_back(Eigen::Map<const RowMajor>(values.data(column, 0, 0), closures, lights));
      grams_.push_back(column_gram(values_.back(), solid_angle_));
      // The light grid is accurate for smooth slices. The albedo of a closure with edges was integrated on a finer
      // grid.
      ColumnGram& gram = grams_.back();
      const Eigen::Map<const Eigen::VectorXd> exact(albedo.data(column, 0), closures);
      gram.albedo = (gram.scale.array() > 0.0).select(exact.cwiseQuotient(gram.scale), 0.0);
    }
  }

  /// Targets for `slices` [slice, column, light] of exact `albedo` [slice, column].
  std::vector<SliceTarget> targets(const Array& slices, const Array& albedo, ThreadPool& pool) const {
    require(slices.ndim() == 3 && slices.shape(1) == static_cast<py::ssize_t>(grams_.size()) &&
                slices.shape(2) == solid_angle_.size(),
            "slices must have the table's columns and light grid");
    const auto columns = grams_.size();
    std::vector<SliceTarget> result(static_cast<std::size_t>(slices.shape(0)) * columns);
    const double* data = slices.data();
    const double* exact = albedo.data();
    const py::gil_scoped_release release;
    pool.run(result.size(), [&](std::size_t k) {
      const std::size_t column = k % columns;
      const Eigen::Map<const Eigen::VectorXd> slice(data + k * static_cast<std::size_t>(solid_angle_.size()),
                                                    solid_angle_.size());
      result[k] =
          slice_target(static_cast<int>(column), grams_[column], values_[column], solid_angle_, slice, exact[k]);
    });
    return result;
  }

  Selection select(const std::vector<SliceTarget>& targets, const SelectionOptions& options,
                   const std::vector<int>& candidates, const std::vector<int>& fixed, ThreadPool& pool) const {
    const ParallelFor parallel = [&](int count, const std::function<void(int)>& body) {
      pool.run(static_cast<std::size_t>(count), [&](std::size_t k) { body(static_cast<int>(k)); });
    };
    return select_closures(grams_, targets, options, candidates, fixed, parallel);
  }

  /// (weights [slice, column, closure], errors [slice, column]) of the targets with the chosen closures.
  py::tuple fit(const std::vector<SliceTarget>& targets, const std::vector<int>& chosen, ThreadPool& pool) const {
    const auto columns = static_cast<py::ssize_t>(grams_.size());
    const auto slices = static_cast<py::ssize_t>(targets.size()) / columns;
    const auto count = static_cast<py::ssize_t>(chosen.size());
    py::array_t<double> weights({slices, columns, count});
    py::array_t<double> errors({slices, columns});
    double* weight = weights.mutable_data();
    double* error = errors.mutable_data();
    {
      const py::gil_scoped_release release;
      pool.run(targets.size(), [&](std::size_t k) {
        Eigen::Map<Eigen::VectorXd> mine(weight + k * chosen.size(), static_cast<Eigen::Index>(chosen.size()));
        error[k] = fit_slice(grams_[static_cast<std::size_t>(targets[k].column)], targets[k], chosen, mine);
      });
    }
    return py::make_tuple(weights, errors);
  }

 private:
  Eigen::VectorXd solid_angle_;
  std::vector<Eigen::MatrixXd> values_;
  std::vector<ColumnGram> grams_;
};

/// The lobe of one point of `shapes` [point, 3] (roughness, anisotropy, tilt) at its view.
MovingLobe moving_lobe(const Array& shapes, const Array& mu_o, py::ssize_t point) {
  const double* shape = shapes.data(point, 0);
  return {{shape[0], shape[1], shape[2]}, *mu_o.data(point)};
}

void require_points(const Array& shapes, const Array& mu_o) {
  require(shapes.ndim() == 2 && shapes.shape(1) == 3 && mu_o.ndim() == 1 && mu_o.shape(0) == shapes.shape(0),
          "shapes must be [point, 3] and mu_o [point]");
}

/// Values [point, light] of lobes with `shapes` [point, 3] at views `mu_o` [point].
py::array_t<double> moving_values(const Array& shapes, const Array& mu_o, const LightDirections& light) {
  require_points(shapes, mu_o);
  py::array_t<double> values({shapes.shape(0), static_cast<py::ssize_t>(light.x.size())});
  for (py::ssize_t k = 0; k < shapes.shape(0); ++k)
    moving_lobe(shapes, mu_o, k).values(light, Eigen::Map<Eigen::VectorXd>(values.mutable_data(k, 0), light.x.size()));
  return values;
}

/// Directional albedos [point] of the same lobes.
py::array_t<double> moving_albedos(const Array& shapes, const Array& mu_o) {
  require_points(shapes, mu_o);
  py::array_t<double> albedos(shapes.shape(0));
  for (py::ssize_t k = 0; k < shapes.shape(0); ++k) *albedos.mutable_data(k) = moving_lobe(shapes, mu_o, k).albedo();
  return albedos;
}

/// Lobes with `shapes` [point, 5] (see OrientedShape) at views with `mu_o` [point] and `phi_o` [point].
OrientedLobe oriented_lobe(const Array& shapes, const Array& mu_o, const Array& phi_o, py::ssize_t point) {
  const double* shape = shapes.data(point, 0);
  return {{shape[0], shape[1], shape[2], shape[3], shape[4]}, *mu_o.data(point), *phi_o.data(point)};
}

void require_oriented(const Array& shapes, const Array& mu_o, const Array& phi_o) {
  require(shapes.ndim() == 2 && shapes.shape(1) == 5 && mu_o.ndim() == 1 && phi_o.ndim() == 1 &&
              mu_o.shape(0) == shapes.shape(0) && phi_o.shape(0) == shapes.shape(0),
          "shapes must be [point, 5], mu_o and phi_o [point]");
}

/// Their values [point, light].
py::array_t<double> oriented_values(const Array& shapes, const Array& mu_o, const Array& phi_o,
                                    const LightDirections& light) {
  require_oriented(shapes, mu_o, phi_o);
  const auto lights = light.x.size();
  py::array_t<double> values({shapes.shape(0), static_cast<py::ssize_t>(lights)});
  for (py::ssize_t k = 0; k < shapes.shape(0); ++k)
    oriented_lobe(shapes, mu_o, phi_o, k).values(light, Eigen::Map<Eigen::VectorXd>(values.mutable_data(k, 0), lights));
  return values;
}

/// Their directional albedos [point].
py::array_t<double> oriented_albedos(const Array& shapes, const Array& mu_o, const Array& phi_o) {
  require_oriented(shapes, mu_o, phi_o);
  py::array_t<double> albedos(shapes.shape(0));
  for (py::ssize_t k = 0; k < shapes.shape(0); ++k)
    *albedos.mutable_data(k) = oriented_lobe(shapes, mu_o, phi_o, k).albedo();
  return albedos;
}

/// The views of rows: the cosines of each, and the azimuths of all. Without azimuths, lobes are moving ones.
/// `mirrored`: rows in the planes of symmetry of the facets, at multiples of a quarter turn, are symmetric.
struct FitViews {
  Eigen::VectorXd mu_o;
  Eigen::VectorXd phi_o;
  bool mirrored = false;

  [[nodiscard]] ViewSlices at(Eigen::Index view, Eigen::Index row) const {
    if (phi_o.size() == 0) return {mu_o[view], 0.0, false, {}, {}};
    return {mu_o[view], phi_o[row], mirrored && std::abs(std::sin(2.0 * phi_o[row])) < 1e-9, {}, {}};
  }
};

/// Shapes [row, view, lobe, number] for `slices` [row, channel, view, light] with broad closures [view, closure,
/// light]. `first_row` [view, lobe, number]: known shapes of row 0, or empty.
py::array_t<double> fit_moving(const Array& slices, const Array& broad, const FitViews& views_of_rows,
                               const LightDirections& light, const Eigen::VectorXd& solid_angle,
                               MovingFitOptions options, const Array& first_row, ThreadPool& pool) {
  require(slices.ndim() == 4 && broad.ndim() == 3 && slices.shape(2) == broad.shape(0) &&
              slices.shape(3) == broad.shape(2) && slices.shape(3) == solid_angle.size(),
          "slices and broad closures must have the same views and lights");
  const auto views = static_cast<std::size_t>(slices.shape(2));
  std::vector<std::vector<ViewSlices>> rows(static_cast<std::size_t>(slices.shape(0)));
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t v = 0; v < views; ++v) {
      ViewSlices seen = views_of_rows.at(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(row));
      const auto view = static_cast<py::ssize_t>(v);
      seen.broad = Eigen::Map<const RowMajor>(broad.data(view, 0, 0), broad.shape(1), broad.shape(2)).transpose();
      seen.slices.resize(slices.shape(3), slices.shape(1));
      for (py::ssize_t c = 0; c < slices.shape(1); ++c)
        seen.slices.col(c) =
            Eigen::Map<const Eigen::VectorXd>(slices.data(static_cast<py::ssize_t>(row), c, view, 0), slices.shape(3));
      rows[row].push_back(std::move(seen));
    }
  if (views_of_rows.phi_o.size() > 0) options.family = &oriented_family();
  const auto numbers = static_cast<py::ssize_t>(options.family->unknowns());
  std::vector<LobeShapes> known;
  for (py::ssize_t v = 0; first_row.ndim() == 3 && v < first_row.shape(0); ++v)
    known.emplace_back(Eigen::Map<const Eigen::VectorXd>(first_row.data(v, 0, 0), options.lobes * numbers));
  std::vector<std::vector<LobeShapes>> found;
  {
    const py::gil_scoped_release release;
    found = fit_moving_lobes(
        rows, light, solid_angle, options, [&](std::size_t count, const auto& body) { pool.run(count, body); }, known);
  }
  py::array_t<double> result({slices.shape(0), slices.shape(2), static_cast<py::ssize_t>(options.lobes), numbers});
  double* out = result.mutable_data();
  for (const auto& row : found)
    for (const LobeShapes& shapes : row) out = std::copy(shapes.begin(), shapes.end(), out);
  return result;
}

}  // namespace

void lamina::bind_fit(py::module_& module) {
  module.attr("MAX_CLOSURES") = kMaxClosures;
  py::class_<SliceTarget>(module, "SliceTarget")
      .def_readonly("column", &SliceTarget::column)
      .def_readonly("norm2", &SliceTarget::norm2)
      .def_readonly("albedo", &SliceTarget::albedo)
      .def_readwrite("weight", &SliceTarget::weight);

  py::class_<SelectionOptions>(module, "SelectionOptions")
      .def(py::init<>())
      .def_readwrite("closures", &SelectionOptions::closures)
      .def_readwrite("target_error", &SelectionOptions::target_error)
      .def_readwrite("worst_share", &SelectionOptions::worst_share)
      .def_readwrite("overshoot", &SelectionOptions::overshoot)
      .def_readwrite("swap_passes", &SelectionOptions::swap_passes)
      .def_readwrite("penalty", &SelectionOptions::penalty);

  py::class_<Selection>(module, "Selection")
      .def_readonly("closures", &Selection::closures)
      .def_readonly("mean_error", &Selection::mean_error)
      .def_readonly("worst_error", &Selection::worst_error);

  py::class_<ClosureTable>(module, "ClosureTable")
      .def(py::init<const Array&, Eigen::VectorXd, const Array&>(), py::arg("values"), py::arg("solid_angle"),
           py::arg("albedo"))
      .def("targets", &ClosureTable::targets, py::arg("slices"), py::arg("albedo"), py::arg("pool"))
      .def("select", &ClosureTable::select, py::arg("targets"), py::arg("options"), py::arg("candidates"),
           py::arg("fixed"), py::arg("pool"), py::call_guard<py::gil_scoped_release>())
      .def("fit", &ClosureTable::fit, py::arg("targets"), py::arg("chosen"), py::arg("pool"));

  py::class_<MovingFitOptions>(module, "MovingFitOptions")
      .def(py::init<>())
      .def_readwrite("lobes", &MovingFitOptions::lobes)
      .def_readwrite("stiffness", &MovingFitOptions::stiffness)
      .def_readwrite("iterations", &MovingFitOptions::iterations)
      .def_readwrite("retro", &MovingFitOptions::retro)
      .def_readwrite("most_change", &MovingFitOptions::most_change)
      .def_readwrite("following", &MovingFitOptions::following);
  py::class_<LightDirections>(module, "LightDirections")
      .def(py::init<const Eigen::VectorXd&, const Eigen::VectorXd&>(), py::arg("mu"), py::arg("dphi"));
  module.def("moving_values", &moving_values, py::arg("shapes"), py::arg("mu_o"), py::arg("light"));
  module.def("moving_albedos", &moving_albedos, py::arg("shapes"), py::arg("mu_o"));
  module.def("oriented_values", &oriented_values, py::arg("shapes"), py::arg("mu_o"), py::arg("phi_o"),
             py::arg("light"));
  module.def("oriented_albedos", &oriented_albedos, py::arg("shapes"), py::arg("mu_o"), py::arg("phi_o"));
  py::class_<FitViews>(module, "FitViews")
      .def(py::init<const Eigen::VectorXd&, const Eigen::VectorXd&, bool>(), py::arg("mu_o"), py::arg("phi_o"),
           py::arg("mirrored"));
  module.def("fit_moving", &fit_moving, py::arg("slices"), py::arg("broad"), py::arg("views"), py::arg("light"),
             py::arg("solid_angle"), py::arg("options"), py::arg("first_row"), py::arg("pool"));
}
