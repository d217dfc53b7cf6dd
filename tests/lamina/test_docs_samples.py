# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples of the Python guide run, one after the other, in an empty folder; they hold assertions of their own."""

import re
import subprocess
import sys
from pathlib import Path

GUIDE = Path(__file__).parents[2] / "docs/python.md"


def test_every_sample_of_the_guide_runs(tmp_path):
    samples = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(samples) >= 6
    script = tmp_path / "samples.py"
    script.write_text("\n".join(samples), encoding="utf-8")
    ran = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert ran.returncode == 0, ran.stderr
