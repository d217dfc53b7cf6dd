# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line, python -m lamina."""

from .command_line import main

__all__ = ["main"]
