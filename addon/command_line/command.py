# SPDX-License-Identifier: GPL-3.0-or-later
"""`blender -b FILE.blend --command lamina bake|dust|interior|list ...`: the batch for scripts and farms.

Prints one line per material or object on standard output. Exit code: 0 if all went well, 1 if one of them
or the save failed, 2 for invalid arguments, 130 if interrupted. `main` can also be called from tests and bpy
scripts.
"""

import sys

import bpy

from ..base import native
from ..base.messages import RefusedError
from ..properties import migration
from . import arguments, bake_command, dust_command, interior_command, list_command
from .exit_codes import FAILED, INTERRUPTED, OK, USAGE, UsageError

COMMANDS = {"bake": bake_command, "dust": dust_command, "interior": interior_command}

_handle = None


def main(argv):
    """Run the command with the arguments after `--command lamina`. Returns the exit code."""
    try:
        given = arguments.parse(argv)
    except UsageError as error:
        return _complain(f"{error}; see: --command lamina --help", USAGE)
    except SystemExit as stop:  # --help
        return stop.code or OK
    unread = _unread_file()
    if unread:
        return _complain(f"{unread}: Blender could not read this file", USAGE)
    migration.migrate_all()
    try:
        if given.command == "list":
            return list_command.run(given, lambda sentence: _complain(sentence, FAILED))
        return COMMANDS[given.command].run(given)
    except UsageError as error:
        return _complain(error, USAGE)
    except (native.NativeMissingError, RefusedError) as error:
        return _complain(error, FAILED)
    except KeyboardInterrupt as stop:
        return _complain(f"interrupted: {stop.args[0] if stop.args else 'nothing was saved'}", INTERRUPTED)


def _unread_file():
    """The .blend file among Blender's own arguments that it could not read, or ''; Blender goes on then."""
    own = sys.argv[:sys.argv.index("--command")] if "--command" in sys.argv else []
    files = [word for word in own if word.endswith(".blend")]
    return files[-1] if files and not bpy.data.filepath else ""


def _complain(sentence, code):
    print(f"lamina: {sentence}", file=sys.stderr, flush=True)
    return code


def register():
    global _handle
    _handle = bpy.utils.register_cli_command("lamina", main)


def unregister():
    global _handle
    if _handle is not None:
        bpy.utils.unregister_cli_command(_handle)
        _handle = None
