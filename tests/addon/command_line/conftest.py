# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for the tests of `--command lamina ...`."""

import pytest


@pytest.fixture
def captured(capsys):
    """pytest's fixture that captures what a command prints."""
    return capsys


@pytest.fixture
def run(addon, lamina, captured):
    """run(*arguments) -> (exit code, lines of stdout, stderr)"""

    def run(*arguments):
        captured.readouterr()
        code = addon.command_line.command.main([str(one) for one in arguments])
        printed = captured.readouterr()
        lines = [line for line in printed.out.splitlines() if not line.startswith(("Info: ", "Saved "))]
        return code, lines, printed.err

    return run
