# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's zip installed in a real Blender, as a user installs the zip from disk.

LAMINA_BLENDER_ROOT names the root folder of tools/debian_root.sh; LAMINA_ZIP names the extension.
"""

import os
from pathlib import Path

import pytest
from chroot_blender import INSIDE, ChrootBlender

HERE = Path(__file__).parent
SCRIPTS = [*sorted((HERE / "inside").glob("*.py")), HERE.parents[1] / "tools" / "blender_window.py"]


@pytest.fixture(scope="session")
def blender(tmp_path_factory):
    """ChrootBlender with the extension enabled, and with the scripts of the folder `inside`."""
    root, archive = (os.environ.get(name) for name in ("LAMINA_BLENDER_ROOT", "LAMINA_ZIP"))
    if not root or not archive:
        pytest.skip("LAMINA_BLENDER_ROOT and LAMINA_ZIP name no Blender and no extension: run `make test-blender`")
    blender = ChrootBlender(root, tmp_path_factory.mktemp("blender"))
    blender.put(*SCRIPTS)
    (inside,) = blender.put(archive)
    finished = blender.run("--python-exit-code", "1", "--python", f"{INSIDE}/install.py", "--", inside)
    assert finished.returncode == 0, finished.stdout + finished.stderr
    return blender
