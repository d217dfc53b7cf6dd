# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina list`: the materials that have layers, and the state of their bakes."""

import json

import bpy

from ..base import messages, native
from ..editing import stack_io
from ..stack_json import stack_check
from . import selection, words
from .exit_codes import FAILED, OK, UsageError


def run(arguments, complain):
    """Print the lists of all files. Returns the exit code. `complain(sentence)` prints an error. Raises
    UsageError."""
    files, others = selection.split(arguments.names)
    if others:
        raise UsageError(f"{others[0]}: must end in .blend")
    entries, failed = [], False
    for file in selection.files(files) or [None]:
        try:
            if file is not None:
                selection.open_file(file)
        except messages.RefusedError as error:
            complain(error)
            failed = True
            continue
        found = [one for one in bpy.data.materials if one.lamina.enabled]
        for material in sorted(found, key=lambda one: one.name):
            if arguments.json:
                entries.append(_entry(material))
            else:
                print("" if file is None else f"{file}: ", _line(material), sep="")
    if arguments.json:
        print(json.dumps({"format": "lamina-list", "schema": 1, "materials": entries}))
    if not native.available():
        complain(native.reason())
        failed = True
    return FAILED if failed else OK


def _line(material):
    layers = len(material.lamina.layers)
    return f"{material.name}: {layers} layer{'' if layers == 1 else 's'}, {words.state(material)}"


def _entry(material):
    settings = material.lamina
    entry = {
        "file": bpy.data.filepath or None,
        "material": material.name,
        "linked_from": None if material.library is None else bpy.path.abspath(material.library.filepath),
        "layers": len(settings.layers),
        "quality": settings.quality,
        "basis": settings.basis,
        "state": None,
        "words": words.state(material),
        "stack_hash": None,
        "baked": words.facts(settings.result),
    }
    if native.available():
        stack, _error = stack_check.of(stack_io.to_text(material))
        entry |= {"state": words.state_of(material), "stack_hash": None if stack is None else stack.hash}
    return entry
