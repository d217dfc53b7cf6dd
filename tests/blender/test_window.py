# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension in a Blender window on a virtual screen, with software OpenGL (inside/stories.py)."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from chroot_blender import INSIDE

ROOT = Path(__file__).parents[2]
SEEDS = range(1, 1 + int(os.environ.get("LAMINA_SEEDS", "1")))
ACTIONS = int(os.environ.get("LAMINA_ACTIONS", "200"))

SEGMENTATION_FAULT = 139
# A fault of Blender 4.3.2 itself, see "Beside previews" of docs/limits.md: where Debian's executable goes through the
# list of renders, RE_FreeUnusedGPUResources.
RACE = range(0x2176D40, 0x2177130)


def crash_report(blender):
    """What Blender has written about its crash; an empty string if it wrote nothing."""
    report = blender.folder / "tmp/blender.crash.txt"
    return report.read_text() if report.exists() else ""


def is_race(report):
    """True if the report of a crash shows the known fault: a call from RACE."""
    return any(int(place, 16) in RACE for place in re.findall(r"blender\(\+0x([0-9a-f]+)\)", report))


def perform(blender, *story, timeout=600):
    """Perform a story of inside/stories.py; returns what Blender printed. Once more after the known fault."""
    (blender.folder / "tmp/blender.crash.txt").unlink(missing_ok=True)
    how = "--python-exit-code", "1", "--python", f"{INSIDE}/stories.py", "--", *map(str, story)
    finished = blender.run(*how, window=True, timeout=timeout)
    if finished.returncode == SEGMENTATION_FAULT and is_race(crash_report(blender)):
        finished = blender.run(*how, window=True, timeout=timeout)
    printed = finished.stdout + finished.stderr
    wrong = f"{printed[-3000:]}\n{crash_report(blender)[:3000]}"
    assert finished.returncode == 0 and "Traceback" not in printed and "Error:" not in finished.stderr, wrong
    return printed


@pytest.mark.parametrize("story", ["panel_drawn", "bake", "cancel", "update", "render", "preset_by_picture",
                                   "overlay_by_picture", "dust_these_objects", "places", "rain", "marble", "soft",
                                   "undo_after_update", "undo_overlay", "undo_beside_interior", "beside_previews",
                                   "another_file", "disabled"])
def test_story(blender, story):
    assert f"story ended: {story}" in perform(blender, story)


def test_previews_stopped_quietly(blender):
    assert "Info:" not in perform(blender, "previews_stopped_quietly")


def test_quit_while_baking(blender):
    perform(blender, "quit_while_baking")


def test_an_asset_is_dropped_on_an_object(blender):
    command = sys.executable, "tools/build_assets.py", "--quality", "preview", "--preset", "dusty-lacquer"
    subprocess.run([*command, "--output", blender.folder], cwd=ROOT, check=True)
    with zipfile.ZipFile(blender.folder / "lamina-assets.zip") as library:
        library.extractall(blender.folder)
    assert "story ended" in perform(blender, "asset_dropped")


@pytest.mark.parametrize("seed", SEEDS)
def test_random_actions(blender, seed):
    assert "story ended" in perform(blender, "random_actions", seed, ACTIONS, timeout=3600)
