// SPDX-License-Identifier: GPL-3.0-or-later
// Binds phase functions, made from a kind and parameters.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

double number(const py::tuple& parameters, std::size_t index) { return parameters[index].cast<double>(); }

std::vector<double> numbers(const py::tuple& parameters, std::size_t index) {
  return parameters[index].cast<std::vector<double>>();
}

void expect_count(const std::string& kind, const py::tuple& parameters, std::size_t count) {
  if (parameters.size() != count) {
    throw py::type_error("phase.kind = '" + kind + "': takes " + std::to_string(count) + " parameters, not " +
                         std::to_string(parameters.size()));
  }
}

template <typename Phase, std::size_t... Index>
Phase from_numbers(const py::tuple& parameters, std::index_sequence<Index...> /*parameters*/) {
  return Phase{number(parameters, Index)...};
}

/// Sets `made` and returns true if Phase is of that kind.
template <typename Phase>
bool make_kind(const std::string& kind, const py::tuple& parameters, std::optional<SinglePhase>& made) {
  if (kind != Phase::kKind) {
    return false;
  }
  // Kinds without parameters ignore any that are given, so that callers can pass a g to every kind.
  if (Phase::kParameters > 0) {
    expect_count(kind, parameters, Phase::kParameters);
  }
  made = from_numbers<Phase>(parameters, std::make_index_sequence<Phase::kParameters>());
  return true;
}

/// The tabulated phase function, given by moments or by samples.
template <>
bool make_kind<Tabulated>(const std::string& kind, const py::tuple& parameters, std::optional<SinglePhase>& made) {
  if (kind == "moments") {
    expect_count(kind, parameters, 1);
    made = Tabulated::from_moments(numbers(parameters, 0));
  } else if (kind == "samples") {
    expect_count(kind, parameters, 2);
    made = Tabulated::from_samples(numbers(parameters, 0), numbers(parameters, 1));
  }
  return made.has_value();
}

template <typename... Phase>
SinglePhase make_any(const std::string& kind, const py::tuple& parameters, const std::variant<Phase...>* /*kinds*/) {
  std::optional<SinglePhase> made;
  if (!(make_kind<Phase>(kind, parameters, made) || ...)) {
    throw py::value_error("phase.kind = '" + kind + "': unknown");
  }
  return *made;
}

SinglePhase make_single(const std::string& kind, const py::tuple& parameters) {
  return make_any(kind, parameters, static_cast<const SinglePhase*>(nullptr));
}

/// Each parameter is a pair (share, (kind, parameters...)).
Mixture make_mixture(const py::tuple& parameters) {
  std::vector<Mixture::Part> parts;
  for (const py::handle& parameter : parameters) {
    const auto [share, phase] = parameter.cast<std::pair<double, py::tuple>>();
    const py::tuple rest = phase[py::slice(1, static_cast<py::ssize_t>(phase.size()), 1)];
    parts.push_back({share, make_single(phase[0].cast<std::string>(), rest)});
  }
  return Mixture(std::move(parts));
}

}  // namespace

PhaseFunction lamina::make_phase(const std::string& kind, const py::tuple& parameters) {
  if (kind == "mixture") {
    return PhaseFunction(make_mixture(parameters));
  }
  return std::visit([](const auto& single) { return PhaseFunction(single); }, make_single(kind, parameters));
}

void lamina::bind_phase(py::module_& module) {
  py::class_<PhaseFunction>(module, "PhaseFunction", "A phase function, by kind and parameters.")
      .def(py::init([](const std::string& kind, const py::args& parameters) { return make_phase(kind, parameters); }),
           py::arg("kind"))
      .def("evaluate", py::vectorize(&PhaseFunction::evaluate), py::arg("cosine"), "4 pi p(cosine): the mean is 1.")
      .def("moment", py::vectorize(&PhaseFunction::moment), py::arg("order"), "The Legendre moment chi_order.")
      .def("sample", py::vectorize(&PhaseFunction::sample), py::arg("u"), "The cosine for u in [0, 1).")
      .def("pdf", py::vectorize(&PhaseFunction::pdf), py::arg("cosine"), "Density of sample over the cosine.")
      .def_property_readonly("peak", &PhaseFunction::peak);
}
