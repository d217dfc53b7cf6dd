# SPDX-License-Identifier: GPL-3.0-or-later
"""The commit that wheels are built from. dist/wheels/COMMIT names it; no wheel of another commit stays beside it."""

import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FILE = "COMMIT"


def commit(root=ROOT):
    """The last commit's hash, followed by " with changes" if the working tree differs from the commit."""
    changed = _git(root, "status", "--porcelain", "--untracked-files=normal")
    return _git(root, "rev-parse", "HEAD") + (" with changes" if changed else "")


def date(root=ROOT):
    """SOURCE_DATE_EPOCH: that of the environment, or the last commit's time."""
    return os.environ.get("SOURCE_DATE_EPOCH") or _git(root, "show", "--no-patch", "--format=%ct", "HEAD")


def of(folder):
    """The commit of the wheels in `folder`; "an unknown commit" if no file names it."""
    file = Path(folder, FILE)
    return file.read_text(encoding="utf-8").strip() if file.is_file() else "an unknown commit"


def begin(folder, now):
    """Makes `folder` one of wheels of the commit `now`. Removes the wheels of another commit, and of one that was
    changed; returns a sentence about those, or None."""
    folder.mkdir(parents=True, exist_ok=True)
    before = of(folder)
    stale = sorted(folder.glob("*.whl")) if before != now or " " in now else []
    for wheel in stale:
        wheel.unlink()
    Path(folder, FILE).write_text(now + "\n", encoding="utf-8")
    return f"removed {len(stale)} wheels of {before}: this is {now}" if stale else None


def _git(root, *words):
    return subprocess.run(["git", *words], cwd=root, check=True, capture_output=True, text=True).stdout.strip()
