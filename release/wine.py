# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows' Pythons under wine 8 of Debian 12, with what wine lacks for them."""

import os
import shutil
import subprocess
from pathlib import Path

import pythons
import ziglang

HERE = Path(__file__).resolve().parent
PROGRAM = Path("/usr/lib/wine/wine64")


def put_start(site):
    """Puts wine_start.py and the library that it loads into a folder of Python's path."""
    source, library = HERE / "wine_math.cpp", site / "wine_math.dll"
    if not library.exists() or library.stat().st_mtime < source.stat().st_mtime:
        cache = str(pythons.cache() / "zig")
        subprocess.run([Path(ziglang.__file__).parent / "zig", "c++", "-target", "x86_64-windows-gnu", "-O3", "-s",
                        "-shared", "-o", library, source], check=True,
                       env={**os.environ, "ZIG_GLOBAL_CACHE_DIR": cache, "ZIG_LOCAL_CACHE_DIR": cache})
    shutil.copy(HERE / "wine_start.py", site / "sitecustomize.py")


def name_of(path):
    """The name of a path of this machine inside wine."""
    return "Z:" + str(path).replace("/", "\\")
