# SPDX-License-Identifier: GPL-3.0-or-later
"""Run tests with the wheels of `make release`: Windows' under wine, ARM's under qemu, Linux's on this machine.

    python release/test.py [--platforms NAME...] [--pythons VERSION...] [--wheels dist/wheels]

The selection below runs with the tolerances of the ordinary tests; under qemu, which takes thirty times as long, QUICK
alone. The wheels for macOS are checked, not run. Left out everywhere: tests whose oracles (SciPy, PythonicDISORT,
Mitsuba) are not installed there, and Blender's.
"""

import re
import sys
from pathlib import Path

import check_wheel
import origin
from foreign import CannotRunError, Runner
from platforms import chosen, parser_of, wheel_name

ROOT = Path(__file__).resolve().parent.parent
# Both modules, the reference cases of tests/data, bakes and rays.
QUICK = (
    "tests/core/numeric/test_quadrature.py",
    "tests/core/numeric/test_thread_pool.py",
    "tests/core/bodies/test_mesh.py",
    "tests/lamina/solver/test_reference_cases.py",
    "tests/lamina/baking/test_lut.py",
)
SELECTION = (
    *QUICK,
    "tests/core/solve/test_accuracy.py",
    "tests/core/matter/test_base_kinds.py",
    "tests/core/solve/test_doubling.py",
    "tests/core/matter/test_graded_sublayers.py",
    "tests/core/solve/test_scattering_ode.py",
    "tests/core/bodies/test_solid.py",
    "tests/lamina/cli/test_command_line.py",
    "tests/lamina/material",
    "tests/lamina/settling/test_dust_texels.py",
    "tests/lamina/settling/test_ply.py",
    "tests/lamina/solver/test_boundaries.py",
    "tests/lamina/solver/test_symmetries.py",
    "tests/lamina/walks/test_shards.py",
)
NEEDS_MORE = "*/test_metal_colours.py"  # Mitsuba and SciPy
# Starts the interpreter again, which the kernel cannot run: qemu runs only the first process.
STARTS_ANOTHER = "tests/core/bodies/test_mesh.py::test_without_the_layer_all_else_works_and_dust_says_why"


def passes(platform, python, wheel):
    """True if the tests pass with the wheel. Raises CannotRunError."""
    tests = SELECTION
    if platform.name == "linux-arm64":
        tests = (*QUICK, f"--deselect={STARTS_ANOTHER}")
    code, last = Runner(platform, python, wheel).run("-m", "pytest", "-p", "no:cacheprovider",
                                                     f"--ignore-glob={NEEDS_MORE}", *tests)
    return code == 0 and bool(re.match(r"\d+ passed\b", last))  # a program that wine aborts has the exit code 0


def main():
    parser = parser_of(__doc__.splitlines()[0])
    parser.add_argument("--wheels", type=Path, default=ROOT / "dist" / "wheels")
    arguments = parser.parse_args()
    print(f"wheels of {origin.of(arguments.wheels)}", flush=True)
    failed = []
    for platform, python in chosen(arguments):
        name = wheel_name(check_wheel.VERSION, platform, python)
        wheel = arguments.wheels.resolve() / name
        faults = check_wheel.wheel_faults(wheel) if wheel.exists() else ["is not there: run make release"]
        if faults:
            failed.append(name)
            print(f"{name}: " + "; ".join(faults), flush=True)
            continue
        print(f"{name}: running", flush=True)
        try:
            failed += [name] * (not passes(platform, python, wheel))
        except CannotRunError as reason:
            print(f"{name}: checked, not run: {reason}", flush=True)
    print("failed: " + ", ".join(failed) if failed else "all wheels are right")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
