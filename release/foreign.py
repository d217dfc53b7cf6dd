# SPDX-License-Identifier: GPL-3.0-or-later
"""How a wheel of another platform is run on this machine: its Python, the emulator and the packages of the tests."""

import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pythons
import wine

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "release"
# On Python 3.11, Blender's numpy; on the newer Pythons, one version for both.
NUMPY = {"3.11": "1.26.4", "3.13": "2.3.5", "3.14": "2.3.5"}
PIP_TAGS = {"windows-x64": ["win_amd64"], "linux-x64": ["manylinux_2_28_x86_64", "manylinux2014_x86_64"],
            "linux-arm64": ["manylinux_2_28_aarch64", "manylinux2014_aarch64"]}
# The C libraries that the wheels for Linux run with: the first from the packages of Debian 11, the second from those of
# Debian 13, which are unpacked with the Python 3.13 that Maven lacks for ARM.
OLD_GLIBC = ("bullseye", "glibc-2.31", ("libc6", "libgcc-s1", "libstdc++6", "zlib1g", "libffi7"))
NEW_GLIBC = ("trixie", "glibc-2.41", ("libc6", "libgcc-s1", "libstdc++6", "zlib1g", "libffi8", "libexpat1",
                                      "libbz2-1.0", "liblzma5", "python3.13-minimal", "libpython3.13-minimal",
                                      "libpython3.13-stdlib"))


class CannotRunError(Exception):
    """This machine cannot run a wheel; the message is the reason."""


class Runner:
    """Runs a platform's Python with one wheel of lamina and nothing else of this machine. Raises CannotRunError."""

    def __init__(self, platform, python, wheel):
        self.platform, self.python = platform, python
        self._prepare = {"windows-x64": self._windows, "linux-x64": self._linux_x64, "linux-arm64": self._linux_arm64}
        if platform.name not in self._prepare:
            raise CannotRunError(f"nothing here emulates {platform.name}")
        self.site = self._site(wheel)

    def _site(self, wheel):
        """A folder with numpy, pytest, hypothesis and the wheel."""
        numpy = f"numpy-{NUMPY[self.python]}"
        folder = BUILD / f"site-{self.platform.name}-{self.python}-{numpy}"
        if not folder.exists():
            BUILD.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=BUILD) as scratch:
                tags = [x for tag in PIP_TAGS[self.platform.name] for x in ("--platform", tag)]
                command = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "install", *tags,
                           "--target", f"{scratch}/site", "--python-version", self.python, "--only-binary=:all:",
                           numpy.replace("-", "=="), "pytest==9.2.0", "hypothesis==6.170.15"]
                if self.platform.name == "windows-x64":
                    command.append("colorama")  # pytest asks for it on Windows, which pip does not see from here
                subprocess.run(command, check=True)
                Path(scratch, "site").rename(folder)
        shutil.rmtree(folder / "lamina", ignore_errors=True)
        with zipfile.ZipFile(wheel) as opened:
            opened.extractall(folder)
        return folder

    def run(self, *arguments):
        """(exit code, last line) of the Python with `arguments`. What the Python prints is printed here.

        The output passes a pipe, because Python under wine does not start when its output is a file.
        """
        command, variables = self._prepare[self.platform.name]()
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

    def _maven(self):
        """The folder of the platform's Python that Maven has."""
        one = self.python, self.platform.classifier
        pythons.fetch({one})
        return pythons.folder_of(*one)

    def _windows(self):
        if not wine.PROGRAM.exists():
            raise CannotRunError("the Debian package wine64 is missing")
        wine.put_start(self.site)
        return [wine.PROGRAM, self._maven() / "python.exe"], {
            "WINEPREFIX": str(BUILD / "wine"), "WINEDEBUG": "-all", "PYTHONPATH": wine.name_of(self.site)}

    def _libraries(self, architecture, glibc):
        """(folder with the libraries of a Debian release, their paths)."""
        suite, name, packages = glibc
        root = pythons.cache() / f"{name}-{architecture}"
        if subprocess.run([ROOT / "release" / "debian_packages.sh", suite, architecture, root, *packages]).returncode:
            raise CannotRunError(f"it needs packages of Debian {suite}")
        folders = {found.resolve() for under in ("lib", "usr/lib") for found in root.glob(f"{under}/*-linux-gnu")}
        return root, sorted(map(str, folders))

    def _linux_x64(self):
        interpreter = self._maven()
        variables = {"PYTHONHOME": str(interpreter), "PYTHONPATH": str(self.site)}
        program = interpreter / "bin" / f"python{self.python}"
        if self.python != "3.11":  # those Pythons need glibc 2.35: the machine's own
            return [program], {**variables, "LD_LIBRARY_PATH": str(interpreter)}
        root, paths = self._libraries("amd64", OLD_GLIBC)
        path = ":".join([str(interpreter), *paths])
        return [root / "lib/x86_64-linux-gnu/ld-2.31.so", "--library-path", path, program], variables

    def _linux_arm64(self):
        if not shutil.which("qemu-aarch64"):
            raise CannotRunError("the Debian package qemu-user is missing")
        root, paths = self._libraries("arm64", OLD_GLIBC if self.python == "3.11" else NEW_GLIBC)
        emulator = ["qemu-aarch64", "-L", root, "-E"]
        variables = {"PYTHONPATH": str(self.site)}
        if self.python == "3.13":
            return [*emulator, f"LD_LIBRARY_PATH={':'.join(paths)}", root / "usr/bin/python3.13"], variables
        interpreter = self._maven()
        return [*emulator, f"LD_LIBRARY_PATH={':'.join([str(interpreter), *paths])}",
                interpreter / "bin" / f"python{self.python}"], {**variables, "PYTHONHOME": str(interpreter)}
