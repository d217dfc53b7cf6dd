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
import libcxx  # noqa: E402
import origin  # noqa: E402
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


@pytest.fixture
def repository(tmp_path):
    """A repository with one commit; git(words) runs git there."""

    def git(*words):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b.example", "-C", tmp_path, *words], check=True,
                       capture_output=True)

    git("init")
    (tmp_path / ".gitignore").write_text("/dist/\n")
    git("add", ".")
    git("commit", "-m", "one")
    git.root = tmp_path
    return git


def test_wheels_of_another_commit_are_removed(repository):
    root, folder = repository.root, repository.root / "dist"
    first = origin.commit(root)
    assert origin.begin(folder, first) is None and origin.of(folder) == first
    (folder / "a.whl").touch()
    assert origin.begin(folder, first) is None and (folder / "a.whl").exists()  # another platform of the same commit
    repository("commit", "--allow-empty", "-m", "two")
    second = origin.commit(root)
    assert origin.begin(folder, second) == f"removed 1 wheels of {first}: this is {second}"
    assert not (folder / "a.whl").exists() and origin.of(folder) == second
    (root / "changed").touch()
    for _ in range(2):  # what was changed has no name, so nothing of before is kept
        (folder / "a.whl").touch()
        assert origin.begin(folder, origin.commit(root)).endswith(f"this is {second} with changes")
    assert origin.date(root).isdigit()


def test_wheels_of_an_unknown_commit_are_removed(tmp_path):
    (tmp_path / "a.whl").touch()
    assert origin.begin(tmp_path, "abc") == "removed 1 wheels of an unknown commit: this is abc"


def test_zigs_library_gets_the_namespace_of_the_toolchain_file(tmp_path):
    toolchains = {platform.name: libcxx.namespace(ROOT / "release" / f"{platform.name}.cmake")
                  for platform in platforms.PLATFORMS}
    assert toolchains == {name: libcxx.OWN if name == "macos-arm64" else None for name in toolchains}
    header = tmp_path / "zig" / libcxx.HEADER
    header.parent.mkdir(parents=True)
    header.write_text(f"#ifndef _LIBCPP___CONFIG\n{libcxx.GUARD}// more\n")
    (tmp_path / "zig" / "other").write_text("kept")
    for _ in range(2):
        libcxx.make(tmp_path / "zig", tmp_path / "own", libcxx.OWN)
        made = (tmp_path / "own" / libcxx.HEADER).read_text()
        assert made.endswith(f"#define _LIBCPP_ABI_NAMESPACE {libcxx.OWN}\n// more\n")
        assert (tmp_path / "own" / "other").read_text() == "kept" and libcxx.OWN not in header.read_text()
    header.write_text("nothing known")
    with pytest.raises(SystemExit, match="does not begin as expected"):
        libcxx.make(tmp_path / "zig", tmp_path / "own", libcxx.OWN)


# Names that zig's linker binds weakly, and one each of the own namespace, of operator new, and of a class of ours.
@pytest.mark.parametrize("name, systems", [
    ("__ZTVNSt3__119basic_ostringstreamIcNS_11char_traitsIcEENS_9allocatorIcEEEE", True),
    ("__ZNSt3__112basic_stringIcNS_11char_traitsIcEENS_9allocatorIcEEED1Ev", True),
    ("__ZN8pybind113setENSt3__16vectorIdEE", True),
    ("__ZTVSt9exception", True), ("__ZNSt13runtime_errorD1Ev", True), ("__ZNKSt9exception4whatEv", True),
    ("__ZTVNSt8__lamina15basic_streambufIcNS_11char_traitsIcEEEE", False),
    ("__ZNSt8__lamina12basic_stringIcNS_11char_traitsIcEENS_9allocatorIcEEED1Ev", False),
    ("__Znwm", False), ("__ZdlPvSt11align_val_t", False), ("__ZN6lamina4walkESt9nothrow_t", False),
])
def test_names_that_the_systems_library_may_define(name, systems):
    assert libcxx.may_be_the_systems(name) == systems


def test_third_party_software_names_what_is_linked_and_each_change_of_embree():
    text = (ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8")
    compiled = text.partition("## Data")[0]
    for name in ("Eigen", "Embree", "pybind11", "libc++", "mingw-w64", "compiler-rt"):
        assert re.search(rf"^\| {re.escape(name)}", compiled, re.M), name
    licences = re.findall(r"\]\((licenses/[^)]+)\)", text)
    assert {path.name for path in (ROOT / "licenses").iterdir()} == {Path(name).name for name in licences}
    script = (ROOT / "tools" / "build_embree.sh").read_text(encoding="utf-8")
    changes = re.findall(r"sed -i .*?(?=\n *[^ '\"\n-])", script.replace("\\\n", " "), re.S)
    assert len(changes) == 7
    for change in changes:
        words = re.findall(r"curve_intersector_virtual|bvh_builder_hair|[a-z0-9_]+\.(?:h|cpp|rc)\b|mmacosx", change)
        words = [word for word in words if word not in ("bvh_intersector1_bvh4.cpp",)]
        for word in words:
            assert word in compiled or word == "mmacosx" and "oldest macOS" in compiled, word


def test_no_page_installs_from_an_index_that_has_no_lamina():
    files = [*(ROOT / "docs").glob("*.md"), ROOT / "README.md", *(ROOT / "native").rglob("*.py")]
    assert not [path.name for path in files if re.search(r'pip install "?lamina\b', path.read_text(encoding="utf-8"))]
