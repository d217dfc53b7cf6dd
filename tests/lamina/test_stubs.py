# SPDX-License-Identifier: GPL-3.0-or-later
"""The type stubs are those of the present compiled modules."""

import subprocess
import sys
from pathlib import Path

import pytest

import lamina

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stubs")
    subprocess.run([sys.executable, ROOT / "tools/make_stubs.py", folder], check=True, cwd=folder)
    return folder


@pytest.mark.parametrize("name", ["_core.pyi", "_mesh.pyi"])
def test_the_stubs_are_current(name, written):
    assert (written / name).read_text() == (ROOT / "native/lamina" / name).read_text(), "run `make stubs`"


def test_the_package_says_that_it_has_types():
    assert (Path(lamina.__file__).parent / "py.typed").is_file()
