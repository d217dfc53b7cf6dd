# SPDX-License-Identifier: GPL-3.0-or-later
"""An extension of Sphinx for docstrings that describe parameters and attributes in lines of their own:

    name: text that may go on
        in indented lines
    other, another: text

Such lines become the parameters in the list of Sphinx. Only names that the object has are recognized.
"""

import contextlib
import inspect
import re

ITEM = re.compile(r"([a-z_]\w*(?:, [a-z_]\w*)*): (.+)")


def setup(app):
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def as_fields(lines, names):
    """The lines of a docstring, with those that describe `names` as fields of Sphinx, one for each name."""
    result, item = [], []
    for line in [*lines, ""]:
        match = ITEM.fullmatch(line)
        if match and set(match[1].split(", ")) <= names:
            result += _fields(item)
            item = [match[1], match[2]]
        elif item and line.startswith(" "):
            item.append(line.strip())
        else:
            result += [*_fields(item), *([""] if item else []), line]
            item = []
    return result


def _fields(item):
    if not item:
        return []
    described, *text = item
    return ["", *(f":param {name}: {' '.join(text)}" for name in described.split(", "))]


def _process(app, what, name, described, options, lines):
    names = set(getattr(described, "__annotations__", {}))
    if callable(described):
        with contextlib.suppress(TypeError, ValueError):  # a class without a signature in Python
            names |= set(inspect.signature(described).parameters)
    lines[:] = as_fields(lines, names)
