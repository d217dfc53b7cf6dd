// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the fit of closures to slices.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "fit/closure_fit.hpp"
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
}
