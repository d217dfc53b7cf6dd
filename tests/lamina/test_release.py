# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of a release that need no other platform: addresses, names of wheels, toolchain files."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "release"))

import description  # noqa: E402
import platforms  # noqa: E402

FIELDS = {"website": "https://lamina.example", "contact": "mail@lamina.example", "pictures": "https://files.example/v1/"}
METADATA = "Metadata-Version: 2.1\nName: lamina\nDescription-Content-Type: text/markdown\n\n"


def test_readme_has_absolute_addresses_on_a_package_index():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "](docs/" in readme
    text = description.described(METADATA + readme, FIELDS)
    head, _, body = text.partition("\n\n")
    assert head.splitlines()[3:] == ["Project-URL: Homepage, https://lamina.example",
                                     "Maintainer-email: mail@lamina.example"]
    targets = re.findall(r"\]\(([^)]*)\)", body)
    assert targets and all(target.startswith("https://") for target in targets)
    for target in re.findall(r"!\[[^]]*\]\(https://files\.example/v1/([^)]*)\)", body):
        assert (ROOT / target).is_file()
    assert len(re.findall(r"!\[[^]]*\]\(https://files\.example/v1/docs/", body)) == readme.count("![")


def test_links_that_are_absolute_already_stay():
    text = METADATA + "[a](https://a.example/b) [c](#d) [e](mailto:f) [g](docs/g.md#h)"
    body = description.described(text, FIELDS).partition("\n\n")[2]
    assert body == "[a](https://a.example/b) [c](#d) [e](mailto:f) [g](https://files.example/v1/docs/g.md#h)"


def test_empty_fields_are_left_out_and_named():
    empty = dict.fromkeys(FIELDS, "")
    text = METADATA + "![a](docs/a.png)"
    assert description.described(text, empty) == text
    assert "website, contact, pictures" in description.missing(empty)
    assert description.missing(FIELDS) is None
    assert "contact:" in description.missing({**FIELDS, "contact": ""})


def test_the_fields_are_those_of_pyproject():
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["lamina"]
    assert set(stated) == set(FIELDS)


@pytest.mark.parametrize("platform", platforms.PLATFORMS, ids=lambda platform: platform.name)
def test_each_platform_has_a_toolchain_and_its_own_wheels(platform):
    text = (ROOT / "release" / f"{platform.name}.cmake").read_text(encoding="utf-8")
    system = {"windows": "Windows", "linux": "Linux", "macos": "Darwin"}[platform.name.split("-")[0]]
    assert f"set(CMAKE_SYSTEM_NAME {system})" in text
    glibc = re.search(r"gnu\.(\d+)\.(\d+)", text)
    assert (f"manylinux_{glibc[1]}_{glibc[2]}_" in platform.tag) == (system == "Linux") if glibc else system != "Linux"
    names = {platforms.wheel_name("1.2.3", platform, python) for python in platforms.PYTHONS}
    assert len(names) == 3 and all(name.endswith(f"-{platform.tag}.whl") for name in names)
    assert f"lamina-1.2.3-cp313-cp313-{platform.tag}.whl" in names


def test_without_apt_one_sentence(tmp_path):
    command = ["/bin/sh", ROOT / "release" / "debian_packages.sh", "trixie", "arm64", tmp_path / "root", "libc6"]
    done = subprocess.run(command, env={"PATH": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode == 3 and not done.stdout and not (tmp_path / "root").exists()
    assert done.stderr == "release: no packages of Debian trixie for arm64: this machine has no apt\n"


def test_wine_gets_every_function_that_its_python_replaces():
    names = re.search(r"NAMES = \(([^)]*)\)", (ROOT / "release" / "wine_start.py").read_text())[1]
    source = (ROOT / "release" / "wine_math.cpp").read_text()
    made = re.findall(r"^(?:REAL|COMPLEX)\((\w+), std::", source, re.M) + re.findall(r" lamina_(\w+)l\(", source)
    assert sorted(re.findall(r'"(\w+)"', names)) == sorted(made)
