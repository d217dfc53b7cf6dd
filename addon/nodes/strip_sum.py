# SPDX-License-Identifier: GPL-3.0-or-later
"""Strips of a table with the same closure: their weights are added before the closure is evaluated."""

from ..kinds.table import METAL, lobe_of


def by_closure(names, metals_apart):
    """{first strip: all strips of its closure}, from the names of strips. `metals_apart`: closures of a metal
    stay apart, since Cycles leaves those out where Metallic is 0."""
    found = {}
    for name in names:
        found.setdefault((metals_apart and name.startswith(METAL), lobe_of(name)), []).append(name)
    return {same[0]: same for same in found.values()}


def weighted(graph, line, names, strip, factor_of):
    """The sum of the strips `names`, each times `factor_of(name)`: a socket, or None for 1.

    `strip(name, column, line, label)` reads a strip and returns a socket."""
    total = None
    for number, name in enumerate(names):
        place = line + 0.2 * number
        weight, factor = strip(name, 7, place, f"weight {name}"), factor_of(name)
        if factor is None:
            total = weight if total is None else graph.vector("ADD", 9.2, place, "sum", weight, total)
        elif total is None:
            total = graph.vector("MULTIPLY", 9.2, place, "part", weight, factor)
        else:
            total = graph.vector("MULTIPLY_ADD", 9.2, place, "sum", weight, factor, total)
    return total
