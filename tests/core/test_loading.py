# SPDX-License-Identifier: GPL-3.0-or-later
"""Loading of the core."""

import re
import subprocess
import sys

import pytest

from lamina import _core


@pytest.mark.skipif(sys.platform != "linux", reason="reads the sections of an ELF file")
def test_no_code_runs_before_the_processor_is_checked():
    """Static objects of the core would be made by instructions that an old processor does not have, before the module
    can refuse that processor in a sentence. One entry is the compiler's own."""
    sections = subprocess.run(["readelf", "-d", _core.__file__], capture_output=True, text=True, check=True).stdout
    assert int(re.search(r"\(INIT_ARRAYSZ\)\s+(\d+)", sections)[1]) == 8
