# SPDX-License-Identifier: GPL-3.0-or-later
"""An extension of Sphinx for docstrings that describe parameters and attributes in lines of their own:

    name: text that may go on
        in indented lines
    other, another: text

Such lines become items of a list. Only names that the object has are recognised.
"""

import contextlib
import inspect
import re

ITEM = re.compile(r"([a-z_]\w*(?:, [a-z_]\w*)*): (.+)")


def setup(app):
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def as_lists(lines, names):
    """The lines of a docstring, with those that describe `names` as items of a list."""
    result, inside = [], False
    for line in lines:
        item = ITEM.fullmatch(line)
        if item and set(item[1].split(", ")) <= names:
            result += [] if inside else [""]
            result.append(f"* **{item[1]}**: {item[2]}")
            inside = True
        elif inside and line.startswith(" "):
            result.append(f"  {line.strip()}")
        else:
            result += [""] if inside else []
            result.append(line)
            inside = False
    return result


def _process(app, what, name, described, options, lines):
    names = set(getattr(described, "__annotations__", {}))
    if callable(described):
        with contextlib.suppress(TypeError, ValueError):  # a class without a signature in Python
            names |= set(inspect.signature(described).parameters)
    lines[:] = as_lists(lines, names)
