# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fresh clone needs of its machine: Debian's packages, Python 3.11, and no newer pip than that of Debian 12. The
programs of other machines are stubs in a folder that is all of PATH."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
INSTALL = ROOT / "tools" / "install_system_packages.sh"
# A Python that has no venv and no headers, of the version $VERSION.
PYTHON = """case "$2" in
*version_info*) [ "$VERSION" = 3.11 ] ;;
*) exit 1 ;;
esac"""
HAS_ALL = "printf 'install ok installed'"
HAS_NONE = "exit 1"


@pytest.fixture
def machine(tmp_path):
    """run(programs, *arguments, **variables): the script on a machine with only these programs and the usual tools."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for tool in ("sh", "cat", "grep", "printf"):
        real = next(path for path in (Path("/bin", tool), Path("/usr/bin", tool)) if path.exists())
        (folder / tool).symlink_to(real)

    def run(programs, *arguments, **variables):
        for name, text in {"id": "echo 1000", **programs}.items():
            (folder / name).write_text(f"#!/bin/sh\n{text}\n")
            (folder / name).chmod(0o755)
        return subprocess.run([INSTALL, *arguments], env={"PATH": str(folder), **variables}, capture_output=True,
                              text=True)

    return run


def test_without_dpkg_one_sentence_with_a_remedy(machine):
    done = machine({"python3.11": PYTHON}, "python3.11", VERSION="3.11")
    assert done.returncode == 1 and not done.stdout
    assert re.fullmatch(r"lamina: no dpkg-query, [^\n]*: build on Debian 12, for example in a container\n", done.stderr)


@pytest.mark.parametrize("arguments", [("",), ("python3",), ("python3.99",)])
def test_without_python_3_11_one_sentence_with_a_remedy(machine, arguments):
    done = machine({"python3": PYTHON, "dpkg-query": HAS_ALL}, *arguments, VERSION="3.13")
    assert done.returncode == 1 and not done.stdout
    assert re.fullmatch(r"lamina: no Python 3\.11, [^\n]*pyenv install 3\.11\), or name it: make PYTHON=FILE\n",
                        done.stderr)


def test_the_packages_of_the_python_that_is_used(machine):
    """On Ubuntu 24.04 python3-venv belongs to Python 3.12, and python3.11 comes from elsewhere."""
    done = machine({"python3.11": PYTHON, "dpkg-query": HAS_NONE}, "python3.11", VERSION="3.11")
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    missing = done.stderr.partition("with sudo:")[2].split()
    assert {"python3.11-venv", "python3.11-dev", "g++"} <= set(missing)
    assert not {"python3-venv", "python3-dev"} & set(missing)


def test_the_packages_are_installed_through_sudo(machine, tmp_path):
    log = tmp_path / "log"
    done = machine({"python3.11": PYTHON, "dpkg-query": HAS_NONE, "sudo": f'echo "$@" >>{log}'}, "python3.11", "maven",
                   VERSION="3.11")
    assert done.returncode == 0, done.stderr
    update, needed, optional = log.read_text().splitlines()
    assert update.startswith("apt-get update") and needed.startswith("apt-get install -y")
    assert needed.split()[-2:] == ["python3.11-venv", "python3.11-dev"] and optional.split()[-1] == "maven"


def test_without_python_3_11_make_says_so_before_all_else(tmp_path):
    done = subprocess.run(["make", "-C", ROOT, "--no-print-directory", "--silent", "PYTHON=", "build/stamps/system",
                           f"--assume-new={INSTALL.relative_to(ROOT)}"], capture_output=True, text=True,
                          env={"PATH": os.environ["PATH"], "HOME": str(tmp_path)})
    assert done.returncode != 0 and done.stderr.splitlines()[0].startswith("lamina: no Python 3.11, which bpy")


def test_pip_of_debian_12_knows_all_options():
    """pip 23.0.1 has --config-settings, and no short form of it (-C came with 23.1)."""
    files = [ROOT / "Makefile", *(ROOT / "release").glob("*.py"), *(ROOT / "tools").glob("*.sh")]
    found = [f"{path.name}: {line.strip()}" for path in files for line in path.read_text(encoding="utf-8").splitlines()
             if re.search(r"""pip.*\s-C\s|PIP\).*\s-C\s|"-C\"""", line)]
    assert not found


def test_without_root_the_first_command_is_left_out_in_one_sentence(tmp_path):
    (tmp_path / "id").write_text("#!/bin/sh\necho 1000\n")
    (tmp_path / "id").chmod(0o755)
    done = subprocess.run([ROOT / "tools" / "test_first_command.sh", sys.executable], cwd=ROOT, capture_output=True,
                          text=True, env={"PATH": f"{tmp_path}:{os.environ['PATH']}"})
    assert done.returncode == 0 and not done.stdout, done.stderr
    assert done.stderr == "lamina: no tests in Debian bookworm: they need root\n"


def test_the_scripts_that_are_called_exist():
    callers = [ROOT / "Makefile", ROOT / ".ci" / "run", *ROOT.glob("tools/*.sh"), *ROOT.glob("release/*.sh")]
    called = {name for caller in callers for name in re.findall(r"\btools/\w+\.(?:sh|py)\b", caller.read_text())}
    assert "tools/debian_root.sh" in called
    assert not [name for name in sorted(called) if not (ROOT / name).is_file()]
