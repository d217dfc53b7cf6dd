# SPDX-License-Identifier: GPL-3.0-or-later
"""The version is defined in pyproject.toml alone; everything else reads it."""

import tomllib
from pathlib import Path

import lamina

ROOT = Path(__file__).parents[2]
READERS = ("CMakeLists.txt", "Makefile", "README.md", "CITATION.cff", "docs/conf.py", "docs/artists.md",
           "addon/blender_manifest.toml", "native/lamina/__init__.py", "native/lamina/_core.pyi")


def test_the_compiled_core_has_the_version_of_the_project():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert lamina.__version__ == version
    assert not [name for name in READERS if version in (ROOT / name).read_text(encoding="utf-8")]
