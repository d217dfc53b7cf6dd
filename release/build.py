# SPDX-License-Identifier: GPL-3.0-or-later
"""Build all wheels on this Linux machine, with zig as cross compiler, and the source archive.

    python release/build.py [--platforms NAME...] [--pythons VERSION...] [--output dist/wheels]

The core is compiled once per platform, the bindings once per Python. What is built stays in build/release, so another
run compiles only what has changed. Wheels of another commit are removed from the output. Needs the packages of
requirements/release.txt, CMake and Maven.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import check_wheel
import description
import libcxx
import origin
import pythons
import ziglang
from platforms import chosen, classifier_of, parser_of, python_tag, wheel_name

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "release"
FIELDS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["lamina"]


def environment(platform):
    """Environment variables of the compilers: zig with its cache beside Embree's."""
    variables = dict(os.environ)
    for name in ("CXXFLAGS", "CFLAGS", "LDFLAGS", "CMAKE_CXX_COMPILER_LAUNCHER"):  # of this machine's compiler
        variables.pop(name, None)
    zig = Path(ziglang.__file__).parent
    variables["LAMINA_ZIG"] = str(zig / "zig")
    own = libcxx.namespace(toolchain(platform))
    if own:
        variables["ZIG_LIB_DIR"] = str(BUILD / "zig-library")
        libcxx.make(zig / "lib", BUILD / "zig-library", own)
    variables["ZIG_GLOBAL_CACHE_DIR"] = variables["ZIG_LOCAL_CACHE_DIR"] = str(pythons.cache() / "zig")
    variables["SOURCE_DATE_EPOCH"] = origin.date()
    variables["LAMINA_TOOLCHAIN"] = str(toolchain(platform))
    variables.setdefault("CMAKE_BUILD_PARALLEL_LEVEL", "2")
    return variables


def toolchain(platform):
    return ROOT / "release" / f"{platform.name}.cmake"


def definitions(platform, python):
    """CMake's variables of a wheel."""
    headers, library = pythons.headers(platform, python)
    values = {
        "CMAKE_TOOLCHAIN_FILE": toolchain(platform),
        "LAMINA_EMBREE": BUILD / f"embree-{platform.name}",
        "Python_INCLUDE_DIR": headers,
        "PYTHON_MODULE_EXTENSION": platform.module_end(python),
        "PYTHON_MODULE_DEBUG_POSTFIX": "",
        "PYTHON_IS_DEBUG": 0,
        "HAS_FLTO": 0,  # pybind11's trials, for each of which zig would compile its C++ library again
        "HAS_FLTO_AUTO": 0,
        "HAS_FLTO_THIN": 0,
    }
    if library:
        values["Python_LIBRARY"] = library
    return values


def build(platform, python, output):
    """One wheel; returns its path. Stops with the faults if the wheel is not right."""
    variables = environment(platform)
    options = [f"build-dir={BUILD / platform.name}", "cmake.python-hints=false"]
    options += [f"cmake.define.{name}={value}" for name, value in definitions(platform, python).items()]
    wheel = output / wheel_name(check_wheel.VERSION, platform, python)
    print(f"Building {wheel.name}", flush=True)
    subprocess.run([ROOT / "tools" / "build_embree.sh", BUILD / f"embree-{platform.name}"], env=variables, check=True)
    with tempfile.TemporaryDirectory(dir=BUILD) as scratch:
        settings = [word for one in options for word in ("--config-settings", one)]  # Debian's pip has no -C
        subprocess.run([sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "wheel", "--no-deps",
                        "--no-build-isolation", "-w", scratch, *settings, ROOT], env=variables, check=True)
        built = next(Path(scratch).glob("*.whl"))
        os.environ["SOURCE_DATE_EPOCH"] = origin.date()  # of the archives that are packed again
        description.describe(built, FIELDS)
        tag = python_tag(python)
        subprocess.run([sys.executable, "-m", "wheel", "tags", "--remove", "--python-tag", tag, "--abi-tag", tag,
                        "--platform-tag", platform.tag, built], check=True, stdout=subprocess.DEVNULL)
        output.mkdir(parents=True, exist_ok=True)
        shutil.move(Path(scratch, wheel.name), wheel)
    faults = check_wheel.wheel_faults(wheel)
    if faults:
        wheel.rename(wheel.with_suffix(".wrong"))
        raise SystemExit(f"release: {wheel.name}: " + "; ".join(faults))
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB", flush=True)
    return wheel


def build_sdist(output):
    """The source archive of the package, lamina-VERSION.tar.gz."""
    program = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    subprocess.run([sys.executable, "-c", program, output], cwd=ROOT, check=True, stdout=subprocess.DEVNULL,
                   env={**os.environ, "SOURCE_DATE_EPOCH": origin.date()})
    return output / f"lamina-{check_wheel.VERSION}.tar.gz"


def main():
    parser = parser_of(__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=ROOT / "dist" / "wheels")
    arguments = parser.parse_args()
    BUILD.mkdir(parents=True, exist_ok=True)
    wanted = chosen(arguments)
    output, now = arguments.output.resolve(), origin.commit()
    removed = origin.begin(output, now)
    print(f"release: {removed or now}", flush=True)
    build_sdist(output)
    pythons.fetch({(python, classifier_of(platform, python)) for platform, python in wanted})
    for platform, python in wanted:
        build(platform, python, output)
    if description.missing(FIELDS):
        print("release: " + description.missing(FIELDS))


if __name__ == "__main__":
    main()
