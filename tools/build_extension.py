# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the Blender extension from addon/ and wheels: dist/lamina-<version>.zip.

    python tools/build_extension.py WHEEL... [--output dist] [--split-platforms]

Needs the bpy wheel: Blender's own `blender_ext.py` builds and validates the archive. Wheels for several Pythons and
platforms may go into one archive; Blender installs the one that fits. With --split-platforms each platform has an
archive of its own, dist/lamina-<version>-<platform>.zip. Version, website and contact are those of pyproject.toml.

Blender leaves a wheel's files as they are when it installs another wheel of the same version. So the wheels in the
archive have local versions, such as 0.1.0+1f3a90c2, which differ whenever the contents differ.
"""

import argparse
import base64
import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LICENCES = ("LICENSE", "THIRD_PARTY.md")  # beside the folder licenses, which THIRD_PARTY.md refers to
PLATFORMS = (
    # (start of the wheel's platform tag, its end, Blender's name)
    ("manylinux", "x86_64", "linux-x64"),
    ("linux", "x86_64", "linux-x64"),
    ("manylinux", "aarch64", "linux-arm64"),
    ("win_amd64", "", "windows-x64"),
    ("win_arm64", "", "windows-arm64"),
    ("macosx", "arm64", "macos-arm64"),
    ("macosx", "x86_64", "macos-x64"),
)
# Blender's platform of a compiled module, by the number of the processor in the module's header.
ELF_MACHINES = {62: "linux-x64", 183: "linux-arm64"}
PE_MACHINES = {0x8664: "windows-x64", 0xAA64: "windows-arm64"}
MACH_O_MACHINES = {0x01000007: "macos-x64", 0x0100000C: "macos-arm64"}


def blender_ext():
    """Path of Blender's extension tool inside the installed bpy."""
    spec = importlib.util.find_spec("bpy")
    if spec is None:
        raise SystemExit("build_extension: bpy is not installed in this Python")
    for folder in spec.submodule_search_locations:
        for tool in Path(folder).glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return tool
    raise SystemExit("build_extension: this bpy has no blender_ext.py (Blender 4.2 or newer is needed)")


def platform_of(wheel):
    """Blender's platform name for a wheel; refuses wheels of other platforms."""
    tag = wheel.stem.split("-")[-1].split(".")[0]
    for start, end, platform in PLATFORMS:
        if tag.startswith(start) and tag.endswith(end):
            return platform
    raise SystemExit(f"build_extension: {wheel.name}: Blender has no platform {tag}")


def check(wheel, version):
    """Refuse files that are not wheels of this version of lamina."""
    parts = wheel.stem.split("-")
    if wheel.suffix != ".whl" or not wheel.is_file() or len(parts) < 5:
        raise SystemExit(f"build_extension: {wheel}: not a wheel")
    if parts[0] != "lamina" or parts[1] != version:
        raise SystemExit(f"build_extension: {wheel.name}: must be lamina {version}, as pyproject.toml says")
    try:
        with zipfile.ZipFile(wheel) as opened:
            _check_contents(opened, wheel)
    except (zipfile.BadZipFile, KeyError):
        raise SystemExit(f"build_extension: {wheel}: not a wheel") from None


def _check_contents(opened, wheel):
    """Refuse a wheel whose file name says another Python or platform than what is inside."""
    python, abi, platform = wheel.stem.split("-")[-3:]
    inside = opened.read(f"lamina-{version()}.dist-info/WHEEL").decode()
    tags = re.findall(r"(?m)^Tag: *(\S+?)\s*$", inside)
    named = {f"{python}-{abi}-{one}" for one in platform.split(".")}
    if set(tags) != named:
        raise SystemExit(f"build_extension: {wheel.name}: holds a wheel for {', '.join(tags) or 'nothing'}")
    digits = python.removeprefix("cp")
    for name in opened.namelist():
        if name.endswith((".so", ".pyd")):
            compiled = platform_of_module(opened.read(name))
            if compiled != platform_of(wheel):
                raise SystemExit(f"build_extension: {wheel.name}: {name} is compiled for {compiled}")
            if not re.search(rf"\.(cp|cpython-){digits}-", name):
                raise SystemExit(f"build_extension: {wheel.name}: {name} is compiled for another Python")


def with_local_version(wheel, folder):
    """Copy a wheel into `folder`, with a local version from its contents; returns the path of the copy."""
    with zipfile.ZipFile(wheel) as opened:
        contents = {entry.filename: opened.read(entry) for entry in opened.infolist()}
        digest = hashlib.sha256()
        for name in sorted(contents):
            digest.update(f"{name}\0{len(contents[name])}\0".encode() + contents[name])
        plain, local = (f"lamina-{one}" for one in (version(), f"{version()}+{digest.hexdigest()[:8]}"))
        info, local_info = f"{plain}.dist-info/", f"{local}.dist-info/"
        metadata = re.sub(rb"(?m)^Version: .*$", b"Version: " + local.removeprefix("lamina-").encode(),
                          contents[info + "METADATA"], count=1)
        recorded = base64.urlsafe_b64encode(hashlib.sha256(metadata).digest()).rstrip(b"=").decode()
        record = contents[info + "RECORD"].decode().replace(info, local_info)
        record = re.sub(rf"(?m)^{re.escape(local_info)}METADATA,.*$",
                        f"{local_info}METADATA,sha256={recorded},{len(metadata)}", record)
        changed = {info + "METADATA": metadata, info + "RECORD": record.encode()}
        copy = folder / wheel.name.replace(plain, local, 1)
        with zipfile.ZipFile(copy, "w", zipfile.ZIP_DEFLATED) as new:
            for entry in opened.infolist():
                data = changed.get(entry.filename, contents[entry.filename])
                entry.filename = entry.filename.replace(info, local_info)
                new.writestr(entry, data)
    return copy


def platform_of_module(data):
    """Blender's platform name for a compiled module, from its first bytes."""
    if data[:4] == b"\x7fELF":
        found = ELF_MACHINES.get(int.from_bytes(data[18:20], "little"))
    elif data[:2] == b"MZ":
        header = int.from_bytes(data[60:64], "little")
        found = PE_MACHINES.get(int.from_bytes(data[header + 4:header + 6], "little"))
    elif data[:4] == b"\xcf\xfa\xed\xfe":
        found = MACH_O_MACHINES.get(int.from_bytes(data[4:8], "little"))
    else:
        found = None
    return found or "an unknown platform"


def version():
    """Lamina's version, which pyproject.toml alone states."""
    return PROJECT["project"]["version"]


def manifest_with(text, wheels):
    """The manifest's text with the version, and with platforms and wheels before the first table."""
    text, replaced = re.subn(r'(?m)^version = .*$', f'version = "{version()}"', text)
    if replaced != 1:
        raise SystemExit(f"build_extension: the manifest has {replaced} lines of a version: must be 1")
    release = PROJECT["tool"]["lamina"]
    if release["contact"]:
        text = re.sub(r'(?m)^(maintainer = ".*)"$', rf'\1 <{release["contact"]}>"', text)
    if release["website"]:
        text = re.sub(r"(?m)^maintainer = .*$", rf'\g<0>\nwebsite = "{release["website"]}"', text)
    names = ", ".join(f'"{name}"' for name in sorted({platform_of(wheel) for wheel in wheels}))
    files = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in sorted(wheels))
    head, bracket, tables = text.partition("[permissions]")
    return f"{head}platforms = [{names}]\nwheels = [\n{files}]\n\n{bracket}{tables}" if wheels else text


def build(wheels, output, split=False):
    """Build and validate the archive, or with `split` one per platform; returns the paths."""
    source = ROOT / "addon"
    text = (source / "blender_manifest.toml").read_text(encoding="utf-8")
    for wheel in wheels:
        check(wheel, version())
    if split and not wheels:
        raise SystemExit("build_extension: --split-platforms needs a wheel")
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="lamina-extension-") as scratch:
        folder = Path(scratch, "lamina")
        shutil.copytree(source, folder, ignore=shutil.ignore_patterns("__pycache__", "*.pyc", ".*"))
        (folder / "wheels").mkdir()
        wheels = [with_local_version(wheel, folder / "wheels") for wheel in wheels]
        (folder / "blender_manifest.toml").write_text(manifest_with(text, wheels), encoding="utf-8")
        for name in LICENCES:
            shutil.copy2(ROOT / name, folder)
        shutil.copytree(ROOT / "licenses", folder / "licenses")
        built = Path(scratch, "built")
        built.mkdir()
        _run("build", "--source-dir", str(folder), "--output-dir", str(built), *["--split-platforms"][:split])
        archives = sorted(built.glob("*.zip"))
        for archive in archives:
            if "SOURCE_DATE_EPOCH" in os.environ:
                date(archive, int(os.environ["SOURCE_DATE_EPOCH"]))
            _run("validate", str(archive))
        return [Path(shutil.move(archive, output / archive.name)) for archive in archives]


def date(archive, seconds):
    """Gives all files of an archive one time, as in wheels: the same sources then give the same bytes."""
    dated = archive.with_suffix(".dated")
    with zipfile.ZipFile(archive) as old, zipfile.ZipFile(dated, "w") as new:
        for entry in old.infolist():
            data = old.read(entry)
            entry.date_time = time.gmtime(seconds)[:6]
            new.writestr(entry, data)
    dated.replace(archive)


def _run(*arguments):
    command = [sys.executable, str(blender_ext()), *arguments]
    finished = subprocess.run(command, capture_output=True, text=True)
    if finished.returncode != 0:
        raise SystemExit(f"build_extension: {arguments[0]} failed:\n{finished.stdout}{finished.stderr}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wheels", nargs="*", type=Path, help="wheels of lamina, one per Python and platform")
    parser.add_argument("--output", type=Path, default=ROOT / "dist", help="folder of the archive")
    parser.add_argument("--split-platforms", action="store_true", help="one archive per platform")
    arguments = parser.parse_args()
    for archive in build(arguments.wheels, arguments.output, arguments.split_platforms):
        print(f"{archive}: {held(archive)}, {archive.stat().st_size / 1e6:.1f} MB")


def held(archive):
    """For which platforms and Pythons an archive has wheels, in words."""
    with zipfile.ZipFile(archive) as opened:
        names = [Path(name) for name in opened.namelist() if name.endswith(".whl")]
    if not names:
        return "no wheel"
    pythons = sorted({int(re.search(r"-cp3(\d+)-", name.name)[1]) for name in names})
    platforms = ", ".join(sorted({platform_of(name) for name in names}))
    return f"{platforms}, Python {', '.join(f'3.{minor}' for minor in pythons)}"


if __name__ == "__main__":
    main()
