# SPDX-License-Identifier: GPL-3.0-or-later
"""Pythons of other platforms, with headers and interpreter, fetched by Maven into the cache of this machine."""

import os
import shutil
import subprocess
import tempfile
import zipfile
from pathlib import Path

from platforms import PYTHONS, classifier_of, digits

ARTIFACT = """<dependency><groupId>org.bytedeco</groupId><artifactId>cpython</artifactId>
<version>{}</version><classifier>{}</classifier></dependency>"""
PROJECT = """<project><modelVersion>4.0.0</modelVersion>
<groupId>lamina</groupId><artifactId>pythons</artifactId><version>1</version><packaging>pom</packaging>
<dependencies>{}</dependencies></project>"""


def cache():
    """The folder that tools/build_embree.sh uses too."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    folder = Path(os.environ.get("LAMINA_CACHE") or Path(base, "lamina"))
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def folder_of(python, classifier):
    """Where the Python of that version and platform is unpacked."""
    return cache() / f"cpython-{PYTHONS[python]}-{classifier}"


def fetch(wanted):
    """Fetch what is missing of `wanted`, a set of (Python's version, the artifact's name of the platform)."""
    missing = sorted(one for one in wanted if not folder_of(*one).exists())
    by_version = {}  # Maven takes one version of an artifact in a project
    for python, classifier in missing:
        by_version.setdefault(python, []).append(classifier)
    for python, classifiers in by_version.items():
        print(f"Fetching Python {python} of {', '.join(classifiers)}", flush=True)
        with tempfile.TemporaryDirectory(dir=cache(), prefix="fetching-") as scratch:
            pom = Path(scratch, "pom.xml")
            pom.write_text(PROJECT.format("".join(ARTIFACT.format(PYTHONS[python], one) for one in classifiers)))
            subprocess.run(["mvn", "-q", "-B", "-f", pom, "dependency:copy-dependencies",
                            "-DexcludeTransitive=true", f"-DoutputDirectory={scratch}"], check=True)
            for classifier in classifiers:
                _unpack(Path(scratch, f"cpython-{PYTHONS[python]}-{classifier}.jar"), python, classifier)


def _unpack(jar, python, classifier):
    inside = f"org/bytedeco/cpython/{classifier}"
    folder = jar.with_suffix("")
    with zipfile.ZipFile(jar) as opened:
        opened.extractall(folder, [name for name in opened.namelist() if name.startswith(inside)])
    for program in folder.glob(f"{inside}/bin/python*"):
        program.chmod(0o755)
    shutil.move(folder / inside, folder_of(python, classifier))


def headers(platform, python):
    """(folder of Python.h, import library or None) of `python` on `platform`."""
    root = folder_of(python, classifier_of(platform, python))
    if platform.name.startswith("windows"):
        return root / "include", root / "libs" / f"python{digits(python)}.lib"
    return root / "include" / f"python{python}", None
