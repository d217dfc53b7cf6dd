// SPDX-License-Identifier: GPL-3.0-or-later
// Binds the walks of stacks and the run of any walk.
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "walks/adding_walk.hpp"
#include "walks/transfer_walk.hpp"

namespace py = pybind11;

namespace {

using namespace lamina;

std::pair<std::unique_ptr<Walk>, double> adding_walk(const Stack& stack, const WalkTarget& target, ThreadPool& pool) {
  AddingWalk made = make_adding_walk(stack, target, pool);
  return {std::move(made.walk), made.table_error};
}

}  // namespace

void lamina::bind_walks(py::module_& module) {
  const auto unlocked = py::call_guard<py::gil_scoped_release>();
  py::class_<Walk>(module, "Walk");
  py::class_<WalkTarget>(module, "WalkTarget",
                         "The quantity that a walk estimates; flux: over all outgoing directions.")
      .def(py::init([](double mu_o, double mu_i, double dphi, Side side, Path path, bool flux, double phi) {
             return WalkTarget{side, path, mu_o, mu_i, dphi, flux, phi};
           }),
           py::arg("mu_o"), py::arg("mu_i"), py::arg("dphi"), py::arg("side") = Side::kTop,
           py::arg("path") = Path::kReflect, py::arg("flux") = false, py::arg("phi") = 0.0);
  py::enum_<NextEvent>(module, "NextEvent")
      .value("from_both_ends", NextEvent::kFromBothEnds)
      .value("fitting", NextEvent::kFitting)
      .value("along_flight", NextEvent::kAlongFlight)
      .value("at_collision", NextEvent::kAtCollision);
  module.attr("WALK_BLOCK") = kWalkBlock;
  module.def("transfer_walk", &make_transfer_walk, py::arg("stack"), py::arg("target"),
             py::arg("next_event") = NextEvent::kFitting, unlocked);
  module.def("adding_walk", &adding_walk, py::arg("stack"), py::arg("target"), py::arg("pool"), unlocked,
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
      "(sum, squares, largest, count, events) over blocks of WALK_BLOCK samples.");
}
