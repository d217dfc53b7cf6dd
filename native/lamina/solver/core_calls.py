# SPDX-License-Identifier: GPL-3.0-or-later
"""Arguments and errors of calls of the core: threads, tolerance, nodes, paths and sides."""

from __future__ import annotations

from .. import _core
from ..common.arguments import check_choice, check_threads, check_whole
from ..common.errors import SolveError

TOLERANCE = {"preview": 1e-2, "final": 1e-3}
_PATHS = {"reflect": _core.Path.reflect, "transmit": _core.Path.transmit}
_SIDES = {"top": _core.Side.top, "bottom": _core.Side.bottom}


def check_nodes(nodes: int | None) -> int | None:
    """A number of nodes per hemisphere, or None for the solver's choice. Raises ArgumentError."""
    return None if nodes is None else check_whole(nodes, "nodes", 8, 160)


def thread_pool(threads: int) -> _core.ThreadPool:
    """The core's pool of `threads` threads, 0 for all hardware threads. Raises ArgumentError."""
    return _core.ThreadPool(check_threads(threads))


def tolerance_of(quality: str) -> float:
    """The relative pointwise tolerance of a quality. Raises ArgumentError."""
    return TOLERANCE[check_choice(quality, "quality", TOLERANCE)]


def or_solve_error(call):
    """The result of `call`. Raises SolveError for the core's RuntimeError."""
    try:
        return call()
    except RuntimeError as error:
        raise SolveError(str(error)) from None


def path_of(path: str) -> _core.Path:
    """The core's value for a path. Raises ArgumentError."""
    return _PATHS[check_choice(path, "path", _PATHS, "'reflect' or 'transmit'")]


def side_of(side: str) -> _core.Side:
    """The core's value for a side. Raises ArgumentError."""
    return _SIDES[check_choice(side, "side", _SIDES, "'top' or 'bottom'")]
