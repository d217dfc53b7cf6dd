# SPDX-License-Identifier: GPL-3.0-or-later
"""How a wheel of another platform is run on this machine: its Python, the emulator and the packages of the tests."""

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pythons
from platforms import classifier_of

ROOT = Path(__file__).resolve().parent.parent
WINE = Path("/usr/lib/wine/wine64")
# On Python 3.11, Blender's numpy; on the newer Pythons, one version for both.
NUMPY = {"3.11": "1.26.4", "3.13": "2.3.5", "3.14": "2.3.5"}
# Wine 8 lacks functions that numpy needs from 2.2 on. On Python 3.14 there is no older numpy.
WINE_NUMPY = {"3.11": "1.26.4", "3.13": "2.1.3"}
# Wine 8 aborts at functions that it lacks. Python has replacements for these two: the management service and CopyFile2.
FOR_WINE = """import sys
import _winapi
sys.modules["_wmi"] = None
vars(_winapi).pop("CopyFile2", None)
"""
PIP_TAGS = {"windows-x64": ["win_amd64"], "linux-x64": ["manylinux_2_28_x86_64", "manylinux2014_x86_64"],
            "linux-arm64": ["manylinux_2_28_aarch64", "manylinux2014_aarch64"]}


class Runner:
    """Runs a platform's Python with one wheel of lamina and nothing else of this machine."""

    def __init__(self, platform, python, wheel):
        self.platform, self.python = platform, python
        classifier = classifier_of(platform, python)
        if classifier != platform.classifier:
            raise SystemExit(f"release: there is no Python {python} of {platform.name} to run")
        pythons.fetch({(python, classifier)})
        self.interpreter = pythons.folder_of(python, classifier)
        self.site = self._site(wheel)

    def _site(self, wheel):
        """A folder with numpy, pytest, hypothesis and the wheel."""
        folder = ROOT / "build" / "release" / f"site-{self.platform.name}-{self.python}"
        if not folder.exists():
            with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
                tags = [x for tag in PIP_TAGS[self.platform.name] for x in ("--platform", tag)]
                is_windows = self.platform.name == "windows-x64"
                numpy = (WINE_NUMPY if is_windows else NUMPY)[self.python]
                command = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "install", *tags,
                           "--target", f"{scratch}/site", "--python-version", self.python, "--only-binary=:all:",
                           f"numpy=={numpy}", "pytest==9.2.0", "hypothesis==6.170.15"]
                if is_windows:
                    command.append("colorama")  # pytest asks for it on Windows, which pip does not see from here
                subprocess.run(command, check=True)
                if is_windows:
                    Path(scratch, "site", "sitecustomize.py").write_text(FOR_WINE)
                Path(scratch, "site").rename(folder)
        for old in folder.glob("lamina/_*"):
            old.unlink()
        with zipfile.ZipFile(wheel) as opened:
            opened.extractall(folder)
        return folder

    def run(self, *arguments):
        """(exit code, last line) of the Python with `arguments`. What the Python prints is printed here.

        The output passes a pipe, because Python under wine does not start when its output is a file.
        """
        command, variables = getattr(self, "_" + self.platform.name.replace("-", "_"))()
        variables = {"PATH": "/usr/bin:/bin", "HOME": "/tmp", "PYTHONDONTWRITEBYTECODE": "1", "PYTHONUTF8": "1",
                     "OPENBLAS_NUM_THREADS": "1", **variables}
        with subprocess.Popen([*command, *map(str, arguments)], env=variables, cwd=ROOT, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
            last = b""
            for line in process.stdout:
                sys.stdout.buffer.write(line)
                sys.stdout.flush()
                last = line if line.strip() else last
        return process.returncode, last.decode(errors="replace")

    def _windows_x64(self):
        if not WINE.exists():
            raise SystemExit("release: the Debian package wine64 is missing")
        prefix = ROOT / "build" / "release" / "wine"
        return [WINE, self.interpreter / "python.exe"], {
            "WINEPREFIX": str(prefix), "WINEDEBUG": "-all", "PYTHONPATH": _of_windows(self.site)}

    def _libraries(self, architecture):
        """(folder with the libraries of Debian 11, which has glibc 2.31; library path)."""
        root = pythons.cache() / f"glibc-2.31-{architecture}"
        subprocess.run([ROOT / "release" / "glibc_root.sh", architecture, root], check=True)
        folders = [self.interpreter, *sorted(root.glob("lib/*-linux-gnu")), *sorted(root.glob("usr/lib/*-linux-gnu"))]
        return root, ":".join(map(str, folders))

    def _linux_x64(self):
        variables = {"PYTHONHOME": str(self.interpreter), "PYTHONPATH": str(self.site)}
        program = self.interpreter / "bin" / f"python{self.python}"
        if self.python != "3.11":  # those Pythons need glibc 2.35: the machine's own
            return [program], {**variables, "LD_LIBRARY_PATH": str(self.interpreter)}
        root, path = self._libraries("amd64")
        return [root / "lib/x86_64-linux-gnu/ld-2.31.so", "--library-path", path, program], variables

    def _linux_arm64(self):
        if self.python != "3.11":
            raise SystemExit(f"release: Python {self.python} of {self.platform.name} needs glibc 2.35: not run")
        root, path = self._libraries("arm64")
        return ["qemu-aarch64", "-L", root, "-E", f"LD_LIBRARY_PATH={path}",
                self.interpreter / "bin" / f"python{self.python}"], {
            "PYTHONHOME": str(self.interpreter), "PYTHONPATH": str(self.site)}


def _of_windows(path):
    """The name of a path of this machine inside wine."""
    return "Z:" + str(path).replace("/", "\\")
