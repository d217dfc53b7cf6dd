# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `presets`: the library of stacks."""

from __future__ import annotations

import argparse
import json

from ..material import presets, user_presets
from ..material.stack import Stack


def add(commands) -> None:
    """Adds the command to a parser."""
    command = commands.add_parser("presets", help="list the library of stacks, or print one as JSON")
    command.add_argument("id", nargs="?", metavar="ID", help="the preset to print")
    command.add_argument("--json", action="store_true", help="the list as JSON")
    command.set_defaults(run=_presets)


def _presets(arguments: argparse.Namespace) -> int:
    if arguments.id is not None:
        own = arguments.id in user_presets.user_names() and arguments.id not in presets.names()
        stack = (user_presets.load_user if own else presets.load)(arguments.id)
        print(json.dumps(stack.to_json(), indent=2))
        return 0
    entries = presets.entries()
    if arguments.json:
        rows = [{"id": entry.id, "name": entry.name, "category": entry.category, "source": entry.source,
                 "stack": entry.stack.to_json()} for entry in entries]
        print(json.dumps(rows, indent=2))
        return 0
    lines = [(entry.id, entry.name, entry.category, _layers(entry.stack)) for entry in entries]
    lines += [(name, "", "Own", str(user_presets.user_folder())) for name in user_presets.user_names()]
    widths = [max(len(line[column]) for line in lines) for column in range(3)]
    for *texts, layers in lines:
        print("  ".join(text.ljust(width) for text, width in zip(texts, widths, strict=True)) + "  " + layers)
    return 0


def _layers(stack: Stack) -> str:
    """Names of the layers and the base, top first."""
    words = [layer.name or layer.kind for layer in stack.layers]
    words.append("sheet" if stack.base is None else stack.base.kind)
    return " / ".join(words)
