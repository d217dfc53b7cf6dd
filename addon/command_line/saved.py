# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on the open file in a terminal, which is saved at its end if it is to be saved."""

import sys
from contextlib import contextmanager, nullcontext

from . import blend_saving, selection, waiting
from .file_lock import FileLock


@contextmanager
def saved(arguments):
    """A context around the work, with the lock of the target. After an exception nothing is saved. Raises
    UsageError, SaveError, KeyboardInterrupt."""
    target = selection.targets([None], arguments).get(None)
    if target is not None:
        blend_saving.check_writable(target)
    with waiting.Interruptible(), FileLock(target) if target is not None else nullcontext():
        saving = blend_saving.Saving(target) if target is not None else None
        if saving is not None:
            saving.check_space(0)
        yield
        waiting.check()
        if saving is not None:
            saving.save()
        else:
            print("lamina: nothing was saved (give --save or --output FILE.blend)", file=sys.stderr)
