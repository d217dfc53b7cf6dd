# SPDX-License-Identifier: GPL-3.0-or-later
# Each command sets up what is missing, then runs:
#   make demo        pictures of the scenes; SCENE=, QUALITY= and OPTIONS= choose
#   make check       before a commit: lint, the core's tests and a sample of the others
#   make test        lint, documentation and all tests
#   make test-bpy52 test-blender    the same tests in Blender 5.2, and tests in a Blender with a window
#   make test-debian make demo in a bare Debian 12
#   make lint docs bench study figures previews assets stubs sanitize fuzz wheel extension clean
#   make release test-release    wheels and extensions for all platforms, and tests of them: docs/releasing.md

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
MAKEFLAGS += --no-builtin-rules

# bpy 4.5 LTS runs on Python 3.11 only.
PYTHON ?= $(shell for p in python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null && echo $$p && break; done; true)
# Blender's newer releases run on other Pythons. The extension holds a wheel for each one found here.
OTHER_PYTHONS := $(foreach p,python3.13 python3.14,$(if $(shell tools/find_python.sh $(p)),$(p)))

VENV := .venv
BPY52 := build/bpy52
RUN := $(VENV)/bin/python
PIP := -m pip --quiet --disable-pip-version-check
SCENE ?= all
QUALITY ?= small
BLENDER ?= trixie
# Further options of make_demo.py, such as --turntable 48, of tests/fuzz/run.py, such as --count 100 --first 500, or of
# bench/run.py, such as --quick.
OPTIONS ?=
VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' pyproject.toml)
NATIVE_SOURCES := $(shell find native -name '*.[ch]pp' -o -name '*.py' -o -name '*.pyi' -o -name '*.json' \
	-o -name CMakeLists.txt) CMakeLists.txt pyproject.toml
ADDON_SOURCES := $(shell find addon -type f -not -name '*.pyc')
DOCS_SOURCES := $(shell find docs -type f) CHANGELOG.md tools/docs_math.py tools/docs_docstrings.py
# Of tests/lamina, what `make check` runs: files without Blender that take seconds.
SAMPLE := material solver/test_published_values.py solver/test_symmetries.py baking/test_lut.py cli walks/test_shards.py \
	test_one_version.py test_stubs.py
# Tests of the core that `make check` leaves out: long walks and narrow peaks.
QUICK := not (sharp_peak or promise_with_a_peak or no_tail_hides or unbiased_where_it_is_hard)
WHEEL = build/wheels/lamina-$(VERSION)-cp311-*.whl
BUILD_FOLDER = $(firstword $(wildcard build/cp311-cp311-*))

# Of tests/addon, what `make test-bpy52-part` runs.
BPY52_PART := test_addon_versions.py baking/test_addon_bake.py nodes/test_addon_node_group.py \
	nodes/test_addon_principled.py test_addon_extension.py::test_the_real_archive_bakes
# For two pytest workers on two cores: OpenBLAS would start two threads in each, which wait for one another.
ONE_BLAS_THREAD := OPENBLAS_NUM_THREADS=1
# With --dist loadfile, pytest-xdist starts a new worker in place of one that crashed, and then waits for ever: no restart.
TWO_WORKERS := -m pytest -n 2 --dist loadfile --max-worker-restart=0

.PHONY: demo check test test-bpy52 test-bpy52-part test-blender test-blender-part test-debian lint docs bench test-gpu study study-hard \
	figures previews assets stubs sanitize fuzz wheel extension release test-release clean
.DEFAULT_GOAL := demo

# In a fresh clone the slab is rendered as soon as the solver is compiled: the slab needs neither walks nor dust.
demo:
ifeq ($(SCENE)$(wildcard build/stamps/extension),all)
	@$(MAKE) --no-print-directory -j 2 build/stamps/blender build/stamps/first
	@$(RUN) tools/build_extension.py build/first/*.whl --output build/first
	$(RUN) demo_scenes/make_demo.py slab --quality $(QUALITY) --extension build/first/lamina-$(VERSION).zip
	@$(MAKE) --no-print-directory build/stamps/scenes
	@$(MAKE) --no-print-directory -j 2 build/stamps/extension
	$(RUN) demo_scenes/make_demo.py all --except slab --quality $(QUALITY) $(OPTIONS)
else
	@$(MAKE) --no-print-directory build/stamps/scenes
	@$(MAKE) --no-print-directory -j 2 build/stamps/extension
	$(RUN) demo_scenes/make_demo.py $(SCENE) --quality $(QUALITY) $(OPTIONS)
endif

test: lint docs build/stamps/extension build/stamps/bench
	$(ONE_BLAS_THREAD) $(RUN) $(TWO_WORKERS) tests/core tests/lamina
	LAMINA_WHEELS=build/wheels $(RUN) $(TWO_WORKERS) tests/addon
	$(RUN) $(TWO_WORKERS) tests/cycles

# The tests of add-on and renders in Blender 5.2 LTS, which runs on Python 3.13, and a sample of them.
ifeq ($(filter python3.13,$(OTHER_PYTHONS)),)
test-bpy52 test-bpy52-part:
	@echo "lamina: no tests in Blender 5.2 as a Python module: this machine has no Python 3.13"
else
test-bpy52: extension build/stamps/bpy52
	LAMINA_WHEELS=build/wheels $(BPY52)/bin/python $(TWO_WORKERS) tests/addon
	$(BPY52)/bin/python $(TWO_WORKERS) tests/cycles
test-bpy52-part: build/stamps/bpy52
	LAMINA_WHEELS=build/wheels $(BPY52)/bin/python -m pytest $(addprefix tests/addon/,$(BPY52_PART))
	$(BPY52)/bin/python -m pytest tests/cycles/test_energy_of_sheets.py tests/cycles/test_oriented_material.py \
		tests/cycles/test_sparkle.py \
		"tests/cycles/test_relightable.py::test_exit_albedo_and_distance[forward]"
endif

# In a Blender executable and its window: BLENDER=trixie is Blender 4.3, BLENDER=sid is 5.2. Needs root.
test-blender: build/stamps/extension $(foreach p,$(OTHER_PYTHONS),build/stamps/wheel-$(p))
	tools/test_blender.sh $(RUN) $(BLENDER)

# A sample of them in Blender 4.3, with fewer random actions.
test-blender-part: build/stamps/extension $(patsubst %,build/stamps/wheel-%,$(filter python3.13,$(OTHER_PYTHONS)))
	LAMINA_ACTIONS=40 tools/test_blender.sh $(RUN) trixie \
		-k "test_background or random or (test_story and (bake or update or beside))"

# The README's first command in a bare Debian 12. Needs root.
test-debian: build/stamps/venv
	tools/test_first_command.sh $(RUN) QUALITY=tiny

# Before a commit, within two minutes once all is built.
check: build/stamps/wheel build/stamps/develop
	$(RUN) -m ruff check .
	PYTHONPATH=native $(VENV)/bin/lint-imports --no-cache
	$(RUN) -m mypy
	tools/lint_cpp.sh $(VENV)/bin changed
	$(ONE_BLAS_THREAD) $(RUN) -m pytest -n 2 --durations=10 -k "$(QUICK)" tests/core $(addprefix tests/lamina/,$(SAMPLE))

lint: build/stamps/wheel build/stamps/develop
	$(RUN) -m ruff check .
	PYTHONPATH=native $(VENV)/bin/lint-imports --no-cache
	$(RUN) -m mypy
	tools/lint_cpp.sh $(VENV)/bin all

docs: build/stamps/docs

bench: build/stamps/extension build/stamps/develop build/stamps/bench
	@tools/install_system_packages.sh $(PYTHON) libllvm19
	$(RUN) bench/run.py $(OPTIONS)

# The walks against each other: six minutes on two quiet cores. Measurements that exist are not repeated.
study: build/stamps/wheel build/stamps/develop
	$(RUN) study/run.py

# 1e8 samples of each walk on three hard cases: an hour of one core.
study-hard: build/stamps/wheel build/stamps/develop
	$(RUN) study/run.py hard show

# The tables of docs/figures.md, from the measurements of `make bench`.
figures: build/stamps/wheel
	$(RUN) tools/figure_tables.py

# The pictures of the presets in the panel's picker and in the asset library, addon/pictures/*.jpg.
previews: build/stamps/scenes build/stamps/extension
	$(RUN) demo_scenes/make_demo.py presets --quality final --thumbnails addon/pictures --out build/previews
	$(RUN) demo_scenes/make_demo.py presets --quality final --overlays --out build/previews

# Twelve materials with Cycles on the CPU and on a GPU, if Cycles finds one.
test-gpu: build/stamps/scenes build/stamps/extension
	$(RUN) tools/test_gpu.py $(OPTIONS)

# All presets as Blender assets: dist/lamina-assets.zip.
assets: build/stamps/extension
	$(RUN) tools/build_assets.py --output dist

# Type stubs of the compiled modules, native/lamina/*.pyi.
stubs: build/stamps/wheel build/stamps/develop
	$(RUN) tools/make_stubs.py

# The core's tests under AddressSanitizer with UndefinedBehaviorSanitizer, and under ThreadSanitizer.
sanitize: build/stamps/develop build/stamps/embree
	tools/sanitize.sh address $(RUN)
	tools/sanitize.sh thread $(RUN)

# 3000 random stacks, each in a process of its own; --help of the script lists the options.
fuzz: build/stamps/wheel
	$(RUN) tests/fuzz/run.py $(OPTIONS)

wheel: build/stamps/wheel

extension: build/stamps/extension $(foreach p,$(OTHER_PYTHONS),build/stamps/wheel-$(p))
	$(RUN) tools/build_extension.py build/wheels/*.whl --output dist

# Wheels for all platforms and Pythons, an extension for each platform, the source archive, the list of components and
# the sums of all. PLATFORMS= and PYTHONS= choose; wheels of other commits are removed.
RELEASE_OPTIONS = $(if $(PLATFORMS),--platforms $(PLATFORMS)) $(if $(PYTHONS),--pythons $(PYTHONS))
release: export SOURCE_DATE_EPOCH = $(shell git show --no-patch --format=%ct HEAD)
release: build/stamps/release build/stamps/blender
	@rm -f dist/lamina-$(VERSION)-*.zip dist/lamina-$(VERSION).cdx.json dist/SHA256SUMS
	$(RELEASE_RUN) release/build.py $(RELEASE_OPTIONS) --output dist/wheels
	$(RUN) tools/build_extension.py dist/wheels/lamina-$(VERSION)-*.whl --output dist --split-platforms
	$(RELEASE_RUN) release/sbom.py --output dist/lamina-$(VERSION).cdx.json
	@cd dist && sha256sum lamina-$(VERSION)-*.zip lamina-$(VERSION).cdx.json wheels/* >SHA256SUMS

# Tests with the wheels of `make release`, under wine and qemu.
test-release: build/stamps/release
	@tools/install_system_packages.sh $(PYTHON) wine64 qemu-user
	$(RELEASE_RUN) release/test.py $(RELEASE_OPTIONS) --wheels dist/wheels

clean:
	rm -rf build dist

build/stamps/system: tools/install_system_packages.sh
	@tools/install_system_packages.sh "$(PYTHON)"
	@mkdir -p $(@D) && touch $@

build/stamps/venv: requirements/build.txt build/stamps/system
	@test -x $(RUN) || $(PYTHON) -m venv $(VENV)
	@$(RUN) $(PIP) install -r $<
	@touch $@

build/stamps/blender: requirements/blender.txt build/stamps/venv
	@echo "Installing Blender as a Python module into $(VENV) (400 MB, once)"
	@$(RUN) $(PIP) install --no-compile -r $<
	@touch $@

# What the scenes after the slab need.
build/stamps/scenes: requirements/scenes.txt build/stamps/blender
	@$(RUN) $(PIP) install -r $<
	@touch $@

build/stamps/develop: requirements/develop.txt build/stamps/scenes
	@echo "Installing the tools of the tests and of the documentation into $(VENV)"
	@$(RUN) $(PIP) install -r $<
	@touch $@

build/stamps/embree: tools/build_embree.sh build/stamps/system
	@tools/build_embree.sh build/embree
	@touch $@

# The wheel of the demo's first picture: without walks, searchlight and dust. It stays in build/first: it is neither
# installed nor part of any archive in dist.
build/stamps/first: build/stamps/venv $(NATIVE_SOURCES)
	@echo "Building what the first picture needs of Lamina's native wheel (two minutes)"
	@rm -rf build/first
	@$(RUN) $(PIP) wheel --no-deps --no-build-isolation --config-settings cmake.define.LAMINA_WALKS=OFF -w build/first .
	@touch $@

# Incremental: CMake compiles what has changed since the last wheel.
build/stamps/wheel: build/stamps/venv build/stamps/embree $(NATIVE_SOURCES)
	@echo "Building Lamina's native wheel (two to three minutes the first time)"
	@rm -f $(WHEEL)
	@$(RUN) $(PIP) wheel --no-deps --no-build-isolation -w build/wheels .
	@$(RUN) $(PIP) install --no-deps --force-reinstall $(WHEEL)
	@touch $@

# In the build folder of the first wheel, so that the core is compiled once.
build/stamps/wheel-%: build/stamps/wheel
	@echo "Building Lamina's native wheel for $*"
	@test -x build/venv-$*/bin/python || $$(tools/find_python.sh $*) -m venv build/venv-$*
	@build/venv-$*/bin/python $(PIP) install -r requirements/build.txt
	@build/venv-$*/bin/python $(PIP) wheel --no-deps --no-build-isolation --config-settings build-dir="$(BUILD_FOLDER)" \
		-w build/wheels .
	@touch $@

# Blender 5.2 as a Python module, with Lamina's wheel.
build/stamps/bpy52: tools/install_bpy52.sh requirements/bpy52.txt build/stamps/wheel-python3.13
	@tools/install_bpy52.sh $$(tools/find_python.sh python3.13) $(BPY52)
	@$(BPY52)/bin/python $(PIP) install --no-deps --force-reinstall build/wheels/lamina-$(VERSION)-cp313-*.whl
	@touch $@

EXTENSION_SOURCES := $(ADDON_SOURCES) tools/build_extension.py LICENSE THIRD_PARTY.md
build/stamps/extension: build/stamps/wheel build/stamps/blender $(EXTENSION_SOURCES)
	@echo "Building the Blender extension"
	@$(RUN) tools/build_extension.py $(WHEEL) --output build/extension
	@touch $@

# In a Python of its own: the ordinary build needs none of these tools.
RELEASE_VENV := build/release-venv
RELEASE_RUN := $(RELEASE_VENV)/bin/python
build/stamps/release: requirements/release.txt requirements/build.txt build/stamps/system
	@tools/install_system_packages.sh $(PYTHON) maven
	@test -x $(RELEASE_RUN) || $(PYTHON) -m venv $(RELEASE_VENV)
	@$(RELEASE_RUN) $(PIP) install -r $<
	@touch $@

build/stamps/docs: build/stamps/wheel build/stamps/develop $(DOCS_SOURCES)
	@$(RUN) -m sphinx -W --keep-going --quiet -d build/docs-cache docs build/docs
	@echo "The documentation is in build/docs/index.html"
	@touch $@

# In the build folder of the wheel, with the core that was compiled there.
build/stamps/bench: build/stamps/wheel
	@echo "Building the core's benchmarks"
	@cmake --build $(BUILD_FOLDER) --parallel 2 --target bench_doubling bench_mesh_walk bench_occlusion >/dev/null
	@touch $@
