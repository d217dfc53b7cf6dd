# SPDX-License-Identifier: GPL-3.0-or-later
"""The archive: it can be built, Blender validates, installs and enables it, wheels included.

LAMINA_WHEELS may be a folder of real wheels; then the installed extension must bake with them.
"""

import json
import os
import re
import subprocess
import sys
import time
import tomllib
import zipfile
from pathlib import Path

import own_blender
import pytest

TOOL = own_blender.ROOT / "tools" / "build_extension.py"
VERSION = tomllib.loads((own_blender.ROOT / "pyproject.toml").read_text())["project"]["version"]
TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"

# Facts about the installed extension, printed by a separate process.
SCRIPT = """
import json, os, sys
from pathlib import Path
import bpy, numpy
if sys.argv[2] == "alone":  # without the lamina that this Python has installed
    sys.path[:] = [path for path in sys.path if not (Path(path) / "lamina").is_dir()]
    sys.meta_path[:] = [one for one in sys.meta_path if "lamina" not in getattr(type(one), "__module__", "")]
try:
    done = bpy.ops.extensions.package_install_files(
        filepath=sys.argv[1], repo="user_default", enable_on_install=True)
    module = "bl_ext.user_default.lamina"
    addon = sys.modules.get(module)
    facts = {"done": list(done), "enabled": module in bpy.context.preferences.addons}
    facts["file"] = addon.__file__
    facts["reason"] = addon.base.native.reason()
    facts["lamina"] = getattr(addon.base.native._package, "__file__", "")
    facts["cli"] = addon.command_line.command.main(["list"])
    if not facts["reason"]:
        material = bpy.data.materials.new("Dusty")
        with bpy.context.temp_override(material=material):
            bpy.ops.lamina.add_stack()
            material.lamina.quality = "preview"
            facts["bake"] = list(bpy.ops.lamina.bake())
    bpy.ops.preferences.addon_disable(module=module)
    facts["left"] = hasattr(bpy.types.Material, "lamina")
    print("FACTS " + json.dumps(facts), flush=True)
finally:
    os._exit(0)
"""


# Installs archives one after another, and prints what Blender has unpacked of their wheels.
REPLACING = """
import os, sys
from pathlib import Path
import bpy
try:
    for archive in sys.argv[1:]:
        bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
        (text,) = Path(os.environ["BLENDER_USER_RESOURCES"]).rglob("site-packages/lamina/from_the_wheel.txt")
        print("\\nUNPACKED", text.read_text())
        (info,) = text.parents[1].glob("lamina-*.dist-info")
        (version,) = [line for line in (info / "METADATA").read_text().splitlines() if line.startswith("Version")]
        print(f"INFO {info.name}: {version}", flush=True)
finally:
    os._exit(0)
"""

REFUSED = """
import os
import sys
import bpy
try:
    bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
finally:
    sys.stdout.flush()
    os._exit(0)
"""


def build(output, *wheels):
    command = [sys.executable, str(TOOL), *map(str, wheels), "--output", str(output)]
    return subprocess.run(command, capture_output=True, text=True)


def install(archive, resources, how="alone"):
    """Install the archive into an empty user folder; returns the facts about the installed extension."""
    environment = dict(os.environ, BLENDER_USER_RESOURCES=str(resources))
    command = [sys.executable, "-c", SCRIPT, str(archive), how]
    finished = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)
    lines = [line for line in finished.stdout.splitlines() if line.startswith("FACTS ")]
    assert lines, finished.stdout + finished.stderr
    return json.loads(lines[0][6:]), finished.stderr


def stub_wheel(folder, python=TAG, platform="manylinux_2_34_x86_64", version=VERSION, name="lamina", tag=None,
               modules=(), text=""):
    """A wheel that Blender installs: an empty package with the right names around it.

    `tag`: what the file WHEEL says, if that is not the name's. `modules`: names and contents of compiled modules.
    `text`: of lamina/from_the_wheel.txt; with it Blender finds in RECORD what to remove.
    """
    path = folder / f"{name}-{version}-{python}-{python}-{platform}.whl"
    info = f"{name}-{version}.dist-info"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("lamina/__init__.py", "")
        archive.writestr("lamina/from_the_wheel.txt", text)
        archive.writestr(f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        archive.writestr(f"{info}/WHEEL", f"Wheel-Version: 1.0\nTag: {tag or f'{python}-{python}-{platform}'}\n")
        for module, data in modules:
            archive.writestr(f"lamina/{module}", data)
        names = [f"lamina/__init__.py,,\n{info}/METADATA,,\n{info}/RECORD,,\n"][:bool(text)]
        archive.writestr(f"{info}/RECORD", "".join(names))
    return path


def plain(name):
    """A wheel's name without its local version."""
    return re.sub(r"\+[0-9a-f]{8}(?=-)", "", name)


def manifest_of(archive):
    with zipfile.ZipFile(archive) as opened:
        names = opened.namelist()
        text = opened.read(next(name for name in names if name.endswith("blender_manifest.toml"))).decode()
    return tomllib.loads(text), names


def test_the_archive_holds_the_addon_and_the_wheels(tmp_path):
    wheels = [stub_wheel(tmp_path), stub_wheel(tmp_path, "cp313"), stub_wheel(tmp_path, platform="win_amd64")]
    finished = build(tmp_path / "dist", *wheels)
    assert finished.returncode == 0, finished.stderr
    archive = tmp_path / "dist" / f"lamina-{VERSION}.zip"
    assert finished.stdout.startswith(f"{archive}: linux-x64, windows-x64, Python 3.")
    manifest, names = manifest_of(archive)
    held = [Path(name).name for name in manifest["wheels"]]
    assert sorted(map(plain, held)) == sorted(wheel.name for wheel in wheels)
    assert all(f"wheels/{name}" in names for name in held)
    assert manifest["platforms"] == ["linux-x64", "windows-x64"]
    assert manifest["version"] == VERSION
    assert manifest["id"] == "lamina" and manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert manifest["copyright"] and manifest["maintainer"]
    assert manifest["blender_version_min"] == "4.2.0" and manifest["permissions"]["files"]
    sources = {file.name for file in (own_blender.ROOT / "addon").glob("*.py")}
    assert sources <= {Path(name).name for name in names}
    assert not [name for name in names if "__pycache__" in name or name.endswith(".pyc")]


@pytest.mark.parametrize("split", [[], ["--split-platforms"]])  # Blender then writes the manifest with the present time
def test_of_one_commit_the_archive_has_the_same_bytes(tmp_path, monkeypatch, split):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    wheel, found = stub_wheel(tmp_path), []
    for seconds in (1600000000, 1650000000):
        os.utime(wheel, (seconds, seconds))
        assert build(tmp_path / str(seconds), wheel, *split).returncode == 0
        found.append(next((tmp_path / str(seconds)).glob("*.zip")).read_bytes())
        time.sleep(2.1)  # an archive has times of two seconds
    assert found[0] == found[1]


def test_the_archive_holds_the_licences(tmp_path):
    finished = build(tmp_path, stub_wheel(tmp_path))
    assert finished.returncode == 0, finished.stderr
    with zipfile.ZipFile(tmp_path / f"lamina-{VERSION}.zip") as opened:
        licence = opened.read("LICENSE").decode()
        third_party = opened.read("THIRD_PARTY.md").decode()
        assert "GNU GENERAL PUBLIC LICENSE" in licence and "END OF TERMS AND CONDITIONS" in licence
        texts = re.findall(r"\]\((licenses/[^)]+)\)", third_party)
        assert set(texts) == {f"licenses/{path.name}" for path in (own_blender.ROOT / "licenses").iterdir()}
        for name in texts:
            assert opened.read(name) == (own_blender.ROOT / name).read_bytes()


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"name": "numpy"}, "must be lamina"),
        ({"version": "99.0.0"}, f"must be lamina {VERSION}"),
        ({"platform": "any"}, "Blender has no platform any"),
        ({"platform": "musllinux_1_2_x86_64"}, "Blender has no platform"),
    ],
)
def test_wrong_wheels_do_not_slip_in(tmp_path, changes, sentence):
    finished = build(tmp_path / "dist", stub_wheel(tmp_path, **changes))
    assert finished.returncode != 0 and sentence in finished.stderr
    assert "Traceback" not in finished.stderr and not list(tmp_path.glob("dist/*.zip"))


def elf(machine):
    return b"\x7fELF\x02\x01\x01".ljust(18, b"\0") + machine.to_bytes(2, "little")


def windows(machine):
    return b"MZ".ljust(60, b"\0") + (64).to_bytes(4, "little") + b"PE\0\0" + machine.to_bytes(2, "little")


def mach_o(machine):
    return b"\xcf\xfa\xed\xfe" + machine.to_bytes(4, "little")


X86, ARM, WINDOWS_X86, APPLE = elf(62), elf(183), windows(0x8664), mach_o(0x0100000C)


@pytest.mark.parametrize(
    ("platform", "changes", "sentence"),
    [
        ("win_amd64", {"tag": "cp311-cp311-linux_x86_64"}, "holds a wheel for cp311-cp311-linux_x86_64"),
        ("win_amd64", {"tag": "cp313-cp313-win_amd64"}, "holds a wheel for cp313-cp313-win_amd64"),
        ("win_amd64", {"modules": [("_core.cp311-win_amd64.pyd", X86)]}, "is compiled for linux-x64"),
        ("manylinux_2_28_x86_64", {"modules": [("_core.cpython-311-x86_64-linux-gnu.so", ARM)]},
         "is compiled for linux-arm64"),
        ("macosx_11_0_arm64", {"modules": [("_core.cpython-311-darwin.so", WINDOWS_X86)]}, "compiled for windows-x64"),
        ("manylinux_2_28_aarch64", {"modules": [("_core.cpython-311-aarch64-linux-gnu.so", APPLE)]},
         "is compiled for macos-arm64"),
        ("manylinux_2_28_aarch64", {"modules": [("_core.cpython-313-aarch64-linux-gnu.so", ARM)]},
         "is compiled for another Python"),
        ("win_amd64", {"modules": [("_core.cp311-win_amd64.pyd", b"text")]}, "compiled for an unknown platform"),
    ],
)
def test_a_wheel_is_what_its_name_says(tmp_path, platform, changes, sentence):
    finished = build(tmp_path / "dist", stub_wheel(tmp_path, "cp311", platform, **changes))
    assert finished.returncode == 1 and sentence in finished.stderr
    assert "Traceback" not in finished.stderr and not list(tmp_path.glob("dist/*.zip"))


def test_a_file_that_is_no_wheel_is_refused(tmp_path):
    path = tmp_path / f"lamina-{VERSION}-cp311-cp311-win_amd64.whl"
    path.write_bytes(b"not a wheel")
    finished = build(tmp_path / "dist", path)
    assert finished.returncode == 1 and "not a wheel" in finished.stderr and "Traceback" not in finished.stderr


def test_one_archive_per_platform_with_its_wheels_alone(tmp_path):
    compiled = {
        "manylinux_2_28_x86_64": ("linux_x64", [("_core.cpython-{}-x86_64-linux-gnu.so", X86)]),
        "manylinux_2_28_aarch64": ("linux_arm64", [("_core.cpython-{}-aarch64-linux-gnu.so", ARM)]),
        "win_amd64": ("windows_x64", [("_core.cp{}-win_amd64.pyd", WINDOWS_X86)]),
        "macosx_11_0_arm64": ("macos_arm64", [("_core.cpython-{}-darwin.so", APPLE)]),
    }
    wheels = {}
    for tag, (_, modules) in compiled.items():
        wheels[tag] = [stub_wheel(tmp_path, f"cp{digits}", tag, modules=[(name.format(digits), data)
                                                                         for name, data in modules])
                       for digits in (311, 313)]
    finished = build(tmp_path / "dist", *sum(wheels.values(), []), "--split-platforms")
    assert finished.returncode == 0, finished.stderr
    archives = sorted(path.name for path in (tmp_path / "dist").iterdir())
    assert archives == sorted(f"lamina-{VERSION}-{platform}.zip" for platform, _ in compiled.values())
    assert finished.stdout.count(" MB\n") == 4
    for tag, (platform, _) in compiled.items():
        manifest, names = manifest_of(tmp_path / "dist" / f"lamina-{VERSION}-{platform}.zip")
        assert manifest["build"]["generated"]["platforms"] == [platform.replace("_", "-")]
        held = sorted(Path(name).name for name in names if name.endswith(".whl"))
        assert sorted(map(plain, held)) == sorted(wheel.name for wheel in wheels[tag])
        assert "LICENSE" in {Path(name).name for name in names}


def test_blender_installs_enables_and_disables_it(tmp_path):
    finished = build(tmp_path, stub_wheel(tmp_path))
    assert finished.returncode == 0, finished.stderr
    resources = tmp_path / "user"
    facts, error = install(tmp_path / f"lamina-{VERSION}.zip", resources, "with the installed lamina")
    assert facts["done"] == ["FINISHED"] and facts["enabled"] and not facts["left"]
    assert Path(facts["file"]).is_relative_to(resources)
    assert list(resources.rglob("site-packages/lamina/from_the_wheel.txt"))
    assert "Traceback" not in error


def test_blender_refuses_another_platform_and_nothing_is_left(tmp_path):
    wheel = stub_wheel(tmp_path, platform="win_amd64", modules=[(f"_core.{TAG}-win_amd64.pyd", WINDOWS_X86)])
    finished = build(tmp_path / "dist", wheel)
    assert f"{VERSION}.zip: windows-x64, Python 3." in finished.stdout, finished.stderr
    command = [sys.executable, "-c", REFUSED, str(tmp_path / "dist" / f"lamina-{VERSION}.zip")]
    environment = dict(os.environ, BLENDER_USER_RESOURCES=str(tmp_path / "user"))
    finished = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)
    assert "isn't one of (windows-x64)" in finished.stdout + finished.stderr
    assert not [path for path in (tmp_path / "user").rglob("*") if "lamina" in path.name]


def test_another_build_of_the_same_version_replaces_the_first(tmp_path):
    """Blender unpacks a wheel only if it has none of that version."""
    archives = []
    for text in ("first", "second"):
        folder = tmp_path / text
        folder.mkdir()
        assert build(folder, stub_wheel(folder, text=text)).returncode == 0
        archives.append(str(folder / f"lamina-{VERSION}.zip"))
    command = [sys.executable, "-c", REPLACING, *archives]
    environment = dict(os.environ, BLENDER_USER_RESOURCES=str(tmp_path / "user"))
    finished = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120)
    assert re.findall(r"UNPACKED (.*)", finished.stdout) == ["first", "second"], finished.stdout + finished.stderr
    versions = re.findall(r"INFO lamina-(.*)\.dist-info: Version: (.*)", finished.stdout)
    assert len(set(versions)) == 2 and all(folder == inside for folder, inside in versions)


def test_without_a_wheel_it_is_enabled_and_says_so(tmp_path):
    finished = build(tmp_path)
    assert finished.returncode == 0, finished.stderr
    facts, error = install(tmp_path / f"lamina-{VERSION}.zip", tmp_path / "user")
    assert facts["enabled"] and "Traceback" not in error
    assert "is not installed for Python" in facts["reason"] and facts["cli"] == 1


@pytest.mark.skipif("LAMINA_WHEELS" not in os.environ, reason="LAMINA_WHEELS names no folder of wheels")
def test_the_real_archive_bakes(tmp_path):
    wheels = sorted(Path(os.environ["LAMINA_WHEELS"]).glob("lamina-*.whl"))
    assert wheels
    finished = build(tmp_path, *wheels)
    assert finished.returncode == 0, finished.stderr
    facts, _ = install(tmp_path / f"lamina-{VERSION}.zip", tmp_path / "user")
    assert facts["reason"] == "" and facts["bake"] == ["FINISHED"]
    assert Path(facts["lamina"]).is_relative_to(tmp_path), "from the archive's own wheel"
