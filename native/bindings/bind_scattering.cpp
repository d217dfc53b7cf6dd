// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the walks of the scattering equation and its differential form.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <stdexcept>
#include <string>

#include "bindings.hpp"
#include "guided/guided_transfer_walk.hpp"
#include "guided/isotropic_walk.hpp"
#include "lateral_walks/plane_scattering_walk.hpp"
#include "matter/joined_media.hpp"
#include "solve/evaluation.hpp"
#include "solve/scattering_ode.hpp"
#include "walks/walk_elements.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

/// Makes a medium from knots (tau, albedo, (kind, parameters...)); tau is the optical depth below the top.
GradedMedium make_graded(const std::vector<std::tuple<double, double, py::tuple>>& knots) {
  std::vector<GradedMedium::Knot> all;
  for (const auto& [tau, albedo, phase] : knots) {
    const py::tuple rest = phase[py::slice(1, static_cast<py::ssize_t>(phase.size()), 1)];
    all.push_back({tau, albedo, make_phase(phase[0].cast<std::string>(), rest)});
  }
  return GradedMedium(std::move(all));
}

py::array_t<double> values(const OdeSolution& solution, bool reflect, Eigen::Index targets,
                           const std::vector<double>& dphi) {
  py::array_t<double> result({targets, targets, static_cast<Eigen::Index>(dphi.size())});
  auto out = result.mutable_unchecked<3>();
  for (Eigen::Index o = 0; o < targets; ++o) {
    for (Eigen::Index i = 0; i < targets; ++i) {
      for (std::size_t p = 0; p < dphi.size(); ++p) {
        out(o, i, static_cast<py::ssize_t>(p)) = reflect ? solution.brdf(o, i, dphi[p]) : solution.btdf(o, i, dphi[p]);
      }
    }
  }
  return result;
}

/// The walk of method "scattering" for a stack. The stack may hold only media over nothing or a Lambert surface, and
/// the target must be the BRDF from above.
std::unique_ptr<Walk> scattering_walk(const Stack& stack, const WalkTarget& target) {
  if (target.side != Side::kTop || target.path != Path::kReflect || target.flux) {
    throw std::invalid_argument(
        "method = 'scattering': estimates only the BRDF from above; use 'transfer' for other quantities");
  }
  const GradedMedium medium = [&] {
    try {
      return joined_media(stack);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(std::string("method = 'scattering': ") + error.what() +
                                  "; use 'transfer' for other stacks");
    }
  }();
  if (medium.is_isotropic()) {
    return std::make_unique<IsotropicWalk>(medium, target.mu_o, target.mu_i);
  }
  return make_guided_transfer_walk(medium, target.mu_o, target.mu_i, target.dphi);
}

}  // namespace

void lamina::bind_scattering(py::module_& module) {
  py::class_<GradedMedium>(module, "GradedMedium", "A slab whose albedo times phase function is linear between knots.")
      .def(py::init(&make_graded), py::arg("knots"))
      .def_static(
          "homogeneous",
          [](double albedo, double tau, const std::string& kind, const py::args& parameters) {
            return GradedMedium::homogeneous(albedo, tau, make_phase(kind, parameters));
          },
          py::arg("albedo"), py::arg("tau"), py::arg("phase"))
      .def("over", &GradedMedium::over, py::arg("reflectance"), "The same slab on a Lambert surface.")
      .def_property_readonly("tau", &GradedMedium::tau);
  module.def(
      "joined_media", [](const Stack& stack) { return joined_media(stack); }, py::arg("stack"),
      "The media of a stack and its Lambert base as one graded medium.");

  const auto unlocked = py::call_guard<py::gil_scoped_release>();
  module.def("guided_transfer_walk", &make_guided_transfer_walk, py::arg("medium"), py::arg("mu_o"), py::arg("mu_i"),
             py::arg("dphi"), unlocked, "A photon walk guided by the adjoint internal field of a coarse solution.");
  module.def(
      "isotropic_walk",
      [](const GradedMedium& medium, double mu_o, double mu_i) -> std::unique_ptr<Walk> {
        return std::make_unique<IsotropicWalk>(medium, mu_o, mu_i);
      },
      py::arg("medium"), py::arg("mu_o"), py::arg("mu_i"), unlocked,
      "The scattering equation of isotropic media, guided by tables.");
  module.def("slab_scattering_walk", &make_slab_scattering_walk, py::arg("medium"), py::arg("mu_o"), py::arg("mu_i"),
             py::arg("dphi"), unlocked, "The scattering equation, guided by closed forms alone.");
  module.def("scattering_walk", &scattering_walk, py::arg("stack"), py::arg("target"), unlocked,
             "The most efficient of these for isotropic and for other media.");
  module.def(
      "scattering_ode",
      [](const GradedMedium& medium, const Eigen::VectorXd& mu, const std::vector<double>& dphi, ThreadPool& pool,
         int nodes, double tolerance) {
        const auto solved = [&] {
          const py::gil_scoped_release release;
          return OdeSolution(medium, OdeSettings{nodes, tolerance}, mu, pool);
        }();
        py::dict result;
        result["brdf"] = values(solved, true, mu.size(), dphi);
        result["btdf"] = values(solved, false, mu.size(), dphi);
        result["reflectance"] = solved.reflectance();
        result["transmittance"] = solved.transmittance();
        result["orders"] = solved.orders();
        result["steps"] = solved.steps();
        return result;
      },
      py::arg("medium"), py::arg("mu"), py::arg("dphi"), py::arg("pool"), py::arg("nodes") = 32,
      py::arg("tolerance") = 1e-8, "The differential form: brdf and btdf [mu_o, mu_i, dphi], fluxes by mu_i.");
}
