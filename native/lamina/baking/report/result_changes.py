# SPDX-License-Identifier: GPL-3.0-or-later
"""Which versions of Lamina changed the results of which stacks, so that bakes of earlier versions can be made again.

A change of results enters the table with the version that will contain the change. Entries of versions after the
running one do not count yet."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from ... import _core
from ...closures.narrow_lobes import has_halo
from ...kinds.boundaries import Interface
from ...material.phase import Mixture, Tabulated
from ...material.stack import Stack
from ...solver.sharp_facets import as_mirrors, has_sharp_facets

FIRST = "0.1.0"  # tables of this version do not name a version


@dataclass(frozen=True)
class Change:
    """Since `version`, bakes of the stacks for which `concerns` is true differ visibly from earlier ones. `words` name
    these stacks."""

    version: str
    words: str
    concerns: Callable[[Stack], bool]


def _has_rough_boundary(stack: Stack) -> bool:
    return any(isinstance(layer, Interface) and layer.alpha > 0.0 for layer in stack.layers)


def _has_sharp_facets(stack: Stack) -> bool:
    return has_sharp_facets(stack, as_mirrors(stack))


def _has_table_over_facets(stack: Stack) -> bool:
    tables = any(isinstance(getattr(layer, "phase", None), Tabulated | Mixture) for layer in stack.layers)
    return tables and any(getattr(stack.base, name, 0.0) > 0.0 for name in ("alpha", "roughness"))


CHANGES = (
    Change("0.2.0", "rough boundaries", _has_rough_boundary),
    Change("0.2.0", "narrow facets on an opaque base", _has_sharp_facets),
    Change("0.2.0", "forward-scattering dust over mirrors", has_halo),
    Change("0.2.0", "tabulated phase functions over rough bases", _has_table_over_facets),
)


def changes(version: str, stack: Stack) -> list[Change]:
    """The changes since `version` that concern the stack, oldest first. `version` is empty for a table that names
    none; a text that is not a version counts as earlier than all."""
    known = _numbers(version or FIRST)
    return [change for change in CHANGES
            if known < _numbers(change.version) <= _numbers(_core.__version__) and change.concerns(stack)]


def told(version: str, stack: Stack) -> str:
    """Why a bake by `version` is out of date, such as "baked by 0.1.0; 0.2.0 changed rough boundaries", or ''."""
    found = changes(version, stack)
    if not found:
        return ""
    words = ", ".join(f"{change.version} changed {change.words}" for change in found)
    return f"baked by {version or f'{FIRST} or earlier'}; {words}"


def _numbers(version: str) -> tuple[int, ...]:
    """Such as (0, 2, 0); (0, 0, 0) for a text that does not begin like a version."""
    match = re.match(r"(\d{1,9})\.(\d{1,9})\.(\d{1,9})", version)
    return tuple(map(int, match.groups())) if match else (0, 0, 0)
