# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples of the documents run, and links lead to files."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


@pytest.mark.parametrize(("page", "least"), [("docs/python.md", 10), ("docs/inverse.md", 9), ("docs/gallery.md", 4),
                                              ("README.md", 1)])
def test_every_sample_runs(page, least, tmp_path):
    """Samples run in sequence, in an empty folder; they contain assertions of their own."""
    samples = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)
    assert len(samples) >= least
    script = tmp_path / "samples.py"
    script.write_text("\n".join(samples), encoding="utf-8")
    ran = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert ran.returncode == 0, ran.stderr


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_to_files(page):
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8"))
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert not missing
