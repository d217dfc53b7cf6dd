# SPDX-License-Identifier: GPL-3.0-or-later
# make demo | test | fuzz | bench | study | lint | wheel | extension | clean   Each sets up what is missing, then runs.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
MAKEFLAGS += --no-builtin-rules

# bpy 4.5 LTS runs on Python 3.11 only.
PYTHON ?= $(shell for p in python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null && echo $$p && break; done; true)
# Blender's newer releases run on other Pythons; the extension holds a wheel for each one found here.
OTHER_PYTHONS := $(shell for p in python3.13 python3.14; do $$p -c 'import venv' 2>/dev/null && echo $$p; done; true)

VENV := .venv
RUN := $(VENV)/bin/python
SCENE ?= all
QUALITY ?= small
# Of make_demo.py, such as --turntable 48, or of tests/fuzz/run.py, such as --count 100 --first 500.
OPTIONS ?=
VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' pyproject.toml)
NATIVE_SOURCES := $(shell find native -name '*.[ch]pp' -o -name '*.py' -o -name '*.json' -o -name CMakeLists.txt) \
	CMakeLists.txt pyproject.toml
ADDON_SOURCES := $(shell find addon -type f -not -name '*.pyc')
EXTENSION := dist/lamina-$(VERSION).zip

.PHONY: demo test fuzz bench study study-hard lint wheel extension clean readme
.DEFAULT_GOAL := demo

demo: build/stamps/extension
	$(RUN) demo_scenes/make_demo.py $(SCENE) --quality $(QUALITY) $(OPTIONS)

test: lint build/stamps/extension
	$(RUN) -m pytest -n 2 --dist loadfile tests/core tests/lamina
	LAMINA_WHEELS=build/wheels $(RUN) -m pytest tests/addon
	$(RUN) -m pytest tests/cycles

# 3000 random stacks, each in a process of its own; --help of the script tells the options.
fuzz: build/stamps/wheel
	$(RUN) tests/fuzz/run.py $(OPTIONS)

lint: build/stamps/wheel
	$(RUN) -m ruff check .
	PYTHONPATH=native $(VENV)/bin/lint-imports --no-cache
	tools/lint_cpp.sh $(VENV)/bin

bench: build/stamps/extension build/stamps/bench
	$(RUN) bench/run.py

# The walks against each other: six minutes on two quiet cores; what was measured is not measured again.
study: build/stamps/wheel
	$(RUN) study/run.py

# 1e8 samples of each walk on three hard cases: an hour of one core.
study-hard: build/stamps/wheel
	$(RUN) study/run.py hard show

readme: build/stamps/wheel
	$(RUN) tools/readme_tables.py

wheel: build/stamps/wheel

extension: build/stamps/extension $(foreach p,$(OTHER_PYTHONS),build/stamps/wheel-$(p))
	$(RUN) tools/build_extension.py build/wheels/*.whl --output dist

clean:
	rm -rf build dist

build/stamps/system: tools/install_system_packages.sh
	@if [ -z "$(PYTHON)" ]; then echo "lamina: no Python 3.11 found, which bpy 4.5 LTS needs" >&2; exit 1; fi
	@tools/install_system_packages.sh $(PYTHON)
	@mkdir -p $(@D) && touch $@

build/stamps/venv: requirements.txt build/stamps/system
	@echo "Installing Blender as a Python module and the tools into $(VENV) (400 MB, once)"
	@test -x $(RUN) || $(PYTHON) -m venv $(VENV)
	@$(RUN) -m pip install --quiet --disable-pip-version-check -r requirements.txt
	@touch $@

build/stamps/embree: tools/build_embree.sh build/stamps/system
	@tools/build_embree.sh build/embree
	@touch $@

build/stamps/wheel: build/stamps/venv build/stamps/embree $(NATIVE_SOURCES)
	@echo "Building Lamina's native wheel (about a minute)"
	@rm -f build/wheels/lamina-*-cp311-*.whl
	@$(RUN) -m pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation -w build/wheels .
	@$(RUN) -m pip install --quiet --disable-pip-version-check --no-deps --force-reinstall \
		build/wheels/lamina-$(VERSION)-cp311-*.whl
	@touch $@

build/stamps/wheel-%: build/stamps/system build/stamps/embree $(NATIVE_SOURCES)
	@echo "Building Lamina's native wheel for $*"
	@test -x build/venv-$*/bin/python || $* -m venv build/venv-$*
	@build/venv-$*/bin/python -m pip install --quiet --disable-pip-version-check \
		scikit-build-core==1.1.2 pybind11==3.1.0 ninja==1.13.0
	@build/venv-$*/bin/python -m pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation \
		-w build/wheels .
	@touch $@

build/stamps/extension: build/stamps/wheel $(ADDON_SOURCES) tools/build_extension.py
	@echo "Building the Blender extension"
	@$(RUN) tools/build_extension.py build/wheels/lamina-$(VERSION)-cp311-*.whl --output dist
	@touch $@

build/stamps/bench: build/stamps/venv build/stamps/embree $(NATIVE_SOURCES)
	@echo "Building the core's benchmarks"
	@tools/install_system_packages.sh $(PYTHON) libllvm19
	@cmake -S . -B build/native-bench -DLAMINA_BENCH=ON -DCMAKE_BUILD_TYPE=Release >/dev/null
	@cmake --build build/native-bench --parallel 2 >/dev/null
	@touch $@
