// SPDX-License-Identifier: GPL-3.0-or-later
// Binds stacks and their parts: media, facets, interfaces and bases.
#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "matter/graded_sublayers.hpp"
#include "matter/stack.hpp"
#include "solve/sublayer_choice.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

/// `parameters` of flakes: alpha, share of the extinction, and for metal flakes the complex index, or FilmedFlakes of
/// the same alpha; of fibers: alpha and translucency; see Flakes.
Medium make_medium(double albedo, double tau, const std::string& phase, const py::args& parameters) {
  if (phase == "fibers") {
    const Flakes sides{.alpha = parameters[0].cast<double>(), .translucency = parameters[1].cast<double>()};
    return {albedo, tau, PhaseFunction(), std::make_shared<const Flakes>(sides)};
  }
  if (phase != "flakes") {
    return {albedo, tau, make_phase(phase, parameters)};
  }
  Flakes flakes{parameters[0].cast<double>(), parameters[1].cast<double>()};
  if (parameters.size() > 2 && py::isinstance<FilmedFlakes>(parameters[2])) {
    flakes.filmed = parameters[2].cast<std::shared_ptr<FilmedFlakes>>();
  } else if (parameters.size() > 2) {
    flakes.metal = parameters[2].cast<std::complex<double>>();
  }
  return {albedo, tau, PhaseFunction(), std::make_shared<const Flakes>(flakes)};
}

Facets make_facets(double alpha, const std::string& distribution, bool correlated, bool compensate, double alpha_v,
                   double angle) {
  if (distribution != "ggx" && distribution != "beckmann") {
    throw py::value_error("distribution = '" + distribution + "': must be 'ggx' or 'beckmann'");
  }
  return {alpha,      distribution == "ggx" ? Facets::Distribution::kGgx : Facets::Distribution::kBeckmann,
          correlated, compensate,
          alpha_v,    angle};
}

std::shared_ptr<Film> make_film(
    double ior_above, const std::string& below,
    const std::vector<std::tuple<double, std::complex<double>, std::vector<std::pair<std::complex<double>, double>>>>&
        waves) {
  std::vector<Film::Wave> made;
  for (const auto& [weight, ior_below, sheets] : waves) {
    made.push_back({weight, ior_below, {}});
    for (const auto& [ior, thickness] : sheets) {
      made.back().sheets.push_back({ior, thickness});
    }
  }
  const auto kind = below == "platelet" ? Film::Below::kPlatelet
                    : below == "metal"  ? Film::Below::kMetal
                                        : Film::Below::kMedium;
  return std::make_shared<Film>(ior_above, kind, std::move(made));
}

auto fields(const Facets& facets) {
  return std::make_tuple(facets.alpha, static_cast<int>(facets.distribution), facets.correlated, facets.compensate,
                         facets.alpha_v, facets.angle);
}

void bind_parts(py::module_& module) {
  py::class_<Medium>(module, "Medium").def(py::init(&make_medium), py::arg("albedo"), py::arg("tau"), py::arg("phase"));

  py::class_<Facets>(module, "Facets",
                     "The facets of a rough surface; alpha 0 is smooth; alpha_v is the width across the tangent, 0 as "
                     "alpha. Equal by value, hashable.")
      .def(py::init(&make_facets), py::arg("alpha") = 0.0, py::arg("distribution") = "ggx",
           py::arg("correlated") = true, py::arg("compensate") = true, py::arg("alpha_v") = 0.0, py::arg("angle") = 0.0)
      .def(
          "__eq__", [](const Facets& a, const Facets& b) { return fields(a) == fields(b); }, py::is_operator())
      .def("__hash__", [](const Facets& facets) { return py::hash(py::cast(fields(facets))); });

  py::class_<Film, std::shared_ptr<Film>>(module, "Film",
                                          "Thin films on a 'medium', on a 'metal', or on both faces of a 'platelet'. "
                                          "`waves`: (weight, index below, [(index, "
                                          "thickness in wavelengths), ...] outermost first) by wavelength.")
      .def(py::init(&make_film), py::arg("ior_above"), py::arg("below"), py::arg("waves"));

  py::class_<FilmedFlakes, std::shared_ptr<FilmedFlakes>>(
      module, "FilmedFlakes", "Flakes with films on a metal or a platelet, for flakes of the spread `alpha`.")
      .def(py::init([](const Film& film, double alpha) { return std::make_shared<FilmedFlakes>(film, alpha); }),
           py::arg("film"), py::arg("alpha"));

  py::class_<Interface>(module, "Interface")
      .def(py::init([](double ior, const Facets& facets, std::shared_ptr<Film> film) {
             return Interface{ior, facets, std::move(film)};
           }),
           py::arg("ior"), py::arg("facets") = Facets{.alpha = 0.0}, py::arg("film") = nullptr);
}

void bind_bases(py::module_& module) {
  py::class_<Base>(module, "Base")
      .def_static("none", [] { return Base{}; })
      .def_static("lambert",
                  [](double reflectance) { return Base{.kind = Base::Kind::kLambert, .reflectance = reflectance}; })
      .def_static(
          "conductor",
          [](double eta, double k, const Facets& facets, std::shared_ptr<Film> film) {
            return Base{.kind = Base::Kind::kConductor, .ior = {eta, k}, .facets = facets, .film = std::move(film)};
          },
          py::arg("eta"), py::arg("k"), py::arg("facets") = Facets{.alpha = 0.0}, py::arg("film") = nullptr)
      .def_static(
          "retroreflector",
          [](double reflectance, double alpha) {
            return Base{.kind = Base::Kind::kRetroreflector,
                        .reflectance = reflectance,
                        .facets = {.alpha = alpha, .retro = true}};
          },
          py::arg("reflectance"), py::arg("alpha"))
      .def_static(
          "principled",
          [](double color, double metallic, double roughness, double ior, double specular, double coat,
             double coat_roughness, double coat_ior, double alpha) {
            const PrincipledSockets sockets{color, metallic, roughness, ior, specular, coat, coat_roughness, coat_ior};
            return Base{.kind = Base::Kind::kPrincipled,
                        .facets = {.alpha = alpha},
                        .law = std::make_shared<const PrincipledLaw>(sockets)};
          },
          py::arg("color"), py::arg("metallic"), py::arg("roughness"), py::arg("ior"), py::arg("specular"),
          py::arg("coat"), py::arg("coat_roughness"), py::arg("coat_ior"), py::arg("alpha"),
          "A Principled material by its sockets, indices relative to the medium above. Facets of `alpha` 0 are a "
          "mirror.")
      .def_static(
          "measured",
          [](double low, double high, const py::bytes& steps) {
            const std::string_view bytes(steps);
            std::vector<std::uint16_t> values(bytes.size() / 2);
            for (std::size_t k = 0; k < values.size(); ++k) {
              values[k] = static_cast<std::uint16_t>(static_cast<unsigned char>(bytes[2 * k]) |
                                                     static_cast<unsigned char>(bytes[2 * k + 1]) << 8U);
            }
            auto measured = std::make_shared<const MeasuredReflection>(low, high, values);
            const Facets facets{.alpha = measured->alpha()};
            return Base{.kind = Base::Kind::kMeasured, .facets = facets, .measured = std::move(measured)};
          },
          py::arg("low"), py::arg("high"), py::arg("steps"),
          "A measured material, see MeasuredReflection; `steps`: 16-bit integers, little-endian.")
      .def_property_readonly("alpha", [](const Base& base) { return base.facets.alpha; }, "The width of the facets.");
}

void bind_sublayers(py::module_& module) {
  module.def(
      "sublayers_of", [](const GradedMedium& medium, double coarseness) { return sublayers_of(medium, coarseness); },
      py::arg("medium"), py::arg("coarseness"), "The homogeneous sublayers that replace a graded medium.");
  module.def(
      "count_sublayers",
      [](const Stack& stack, double tolerance, ThreadPool& pool) {
        return resolved_sublayers(stack, tolerance, pool).stack.layers.size();
      },
      py::arg("stack"), py::arg("tolerance"), py::arg("pool"), "The number of layers of the stack as it is solved.");
}

}  // namespace

void lamina::bind_stack(py::module_& module) {
  bind_parts(module);
  bind_bases(module);
  py::class_<Stack>(module, "Stack")
      .def(py::init([](std::vector<Layer> layers, const Base& base) { return Stack{std::move(layers), base}; }),
           py::arg("layers"), py::arg("base") = Base{});
  bind_sublayers(module);
}
