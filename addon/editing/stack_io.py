# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of a material's layers to stacks and back, and their JSON files.

`to_dict` and `assign` need no native module. Checks and hashes of a stack need `lamina`.
"""

import json

from ..base import changes, native, renders
from ..nodes import detail_wiring
from ..properties import migration
from ..stack_json import stack_check, stack_read, stack_write


def to_dict(material):
    """The stack of `material` as plain JSON data, top layer first."""
    return stack_write.stack(material.lamina)


def to_text(material):
    """The stack of `material` as JSON text."""
    return json.dumps(to_dict(material))


def to_stack(material):
    """`lamina.Stack` of the material. Raises lamina.StackError, NativeMissingError."""
    stack, error = stack_check.of(to_text(material))
    if error is not None:
        raise error.with_traceback(None)
    return stack


def assign(material, data):
    """Replace the layers and base of `material` by the JSON data of a *valid* stack.

    Everything is read before anything is changed. Raises RefusedError.
    """
    layers = [stack_read.layer(layer, f"layers[{index}]") for index, layer in enumerate(data["layers"])]
    base, about = stack_read.base(data.get("base")), stack_read.about(data)
    light = stack_read.illuminant(data)
    settings = material.lamina
    migration.start(material)
    renders.stop_previews()
    settings.layers.clear()
    for values in layers:
        _write(settings.layers.add(), values)
    _write(settings.base, base)
    settings.about, settings.illuminant = about, light
    settings.active_index = 0
    for key in (detail_wiring.WANTED, detail_wiring.DUSTED):  # of the earlier layers
        material.pop(key, None)
    changes.tell(material)


def assign_stack(material, stack):
    """Like `assign`, from a `lamina.Stack`."""
    assign(material, stack.to_json())


def import_file(material, path):
    """Read a stack JSON into `material`.

    Raises lamina.StackError, OSError, RefusedError, NativeMissingError; then the material is unchanged.
    """
    assign_stack(material, native.require().Stack.load(path))


def export_file(material, path):
    """Write the stack of `material` as JSON. Raises lamina.StackError, OSError, NativeMissingError."""
    to_stack(material).save(path)


def _write(group, values):
    for key, value in values.items():
        if isinstance(value, dict):
            _write(getattr(group, key), value)
        else:
            setattr(group, key, value)
