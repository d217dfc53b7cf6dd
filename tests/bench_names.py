# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmarks of bench/run.py, and a second of each."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

BENCH = Path(__file__).parents[1] / "bench"


def names(in_blender):
    """The names of the benchmarks that run in Blender, or of the others."""
    spec = importlib.util.spec_from_file_location("lamina_benchmarks", BENCH / "run.py")
    run = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(run)
    own = run.in_its_own("").__qualname__
    return [name for name, (measure, *_) in run.BENCHES.items() if (measure.__qualname__ == own) == in_blender]


def require_a_table(name):
    """Fails unless the benchmark ends well and prints a table with numbers."""
    done = subprocess.run([sys.executable, BENCH / "run.py", "--quick", name], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    # Columns are two spaces apart. Some benchmarks print a summary after their table.
    rows = [re.split(r"\s{2,}", line) for line in done.stdout.splitlines()]
    assert any(re.match(r"\d*\.?\d", cell) for row in rows for cell in row[1:]), done.stdout[-2000:]
