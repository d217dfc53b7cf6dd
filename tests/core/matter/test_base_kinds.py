# SPDX-License-Identifier: GPL-3.0-or-later
"""The core asks a base for its properties, not for its kind, so that a new base changes few files."""

import re
from pathlib import Path

import pytest

NATIVE = Path(__file__).resolve().parents[3] / "native"

# Methods that exist for a Lambert surface only: the scattering equation over a ground, the light of the beam's spot on
# the base, and another reflectance for a solved stack.
FOR_LAMBERT = {"core/matter/joined_media.cpp", "core/lateral/beam_paths.cpp", "core/solve/solution.cpp"}


def files_with(pattern):
    return {path.relative_to(NATIVE).as_posix() for path in NATIVE.rglob("*.[ch]pp")
            if re.search(pattern, path.read_text())}


@pytest.mark.parametrize("pattern, files", [
    (r"\bKind::kConductor\b", {"core/matter/base.hpp", "bindings/bind_stack.cpp"}),
    (r"\bKind::kPrincipled\b", {"bindings/bind_stack.cpp"}),
    (r"\bBase::Kind::kLambert\b", {"bindings/bind_stack.cpp"} | FOR_LAMBERT),
])
def test_kinds_of_bases_are_named_only_where_they_are_described(pattern, files):
    assert files_with(pattern) == files
