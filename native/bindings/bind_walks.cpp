// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "walks/adding_walk.hpp"
#include "walks/transfer_walk.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

WalkTarget target_of(double mu_o, double mu_i, double dphi, Side side, Path path, bool flux) {
  return {side, path, mu_o, mu_i, dphi, flux};
}

std::unique_ptr<Walk> transfer_walk(const Stack& stack, double mu_o, double mu_i, double dphi, Side side, Path path,
                                    bool flux, NextEvent next_event) {
  return make_transfer_walk(stack, target_of(mu_o, mu_i, dphi, side, path, flux), next_event);
}

std::pair<std::unique_ptr<Walk>, double> adding_walk(const Stack& stack, double mu_o, double mu_i, double dphi,
                                                     Side side, Path path, bool flux, ThreadPool& pool) {
  AddingWalk made = make_adding_walk(stack, target_of(mu_o, mu_i, dphi, side, path, flux), pool);
  return {std::move(made.walk), made.table_error};
}

}  // namespace

void lamina::bind_walks(py::module_& module) {
  const auto unlocked = py::call_guard<py::gil_scoped_release>();
  py::class_<Walk>(module, "Walk");
  py::enum_<NextEvent>(module, "NextEvent")
      .value("from_both_ends", NextEvent::kFromBothEnds)
      .value("fitting", NextEvent::kFitting)
      .value("along_flight", NextEvent::kAlongFlight)
      .value("at_collision", NextEvent::kAtCollision);
  module.attr("WALK_BLOCK") = kWalkBlock;
  module.def("transfer_walk", &transfer_walk, py::arg("stack"), py::arg("mu_o"), py::arg("mu_i"), py::arg("dphi"),
             py::arg("side"), py::arg("path"), py::arg("flux") = false, py::arg("next_event") = NextEvent::kFitting,
             unlocked);
  module.def("adding_walk", &adding_walk, py::arg("stack"), py::arg("mu_o"), py::arg("mu_i"), py::arg("dphi"),
             py::arg("side"), py::arg("path"), py::arg("flux"), py::arg("pool"), unlocked,
             "The walk and the error of its tables.");
  module.def(
      "run_walk",
      [](const Walk& walk, std::uint64_t seed, std::uint64_t first, std::uint64_t last, ThreadPool& pool) {
        Tally tally;
        {
          const py::gil_scoped_release release;
          tally = run_walk(walk, seed, first, last, pool);
        }
        return py::make_tuple(tally.sum, tally.squares, tally.largest, tally.count, tally.events);
      },
      py::arg("walk"), py::arg("seed"), py::arg("first_block"), py::arg("last_block"), py::arg("pool"),
      "(sum, squares, largest, count, events) of blocks of WALK_BLOCK samples.");
}
