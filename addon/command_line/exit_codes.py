# SPDX-License-Identifier: GPL-3.0-or-later
"""Exit codes of the batch: see docs/batch.md."""

OK, FAILED, USAGE, INTERRUPTED = 0, 1, 2, 130


class UsageError(Exception):
    """An argument is wrong; str() is one sentence."""
