# SPDX-License-Identifier: GPL-3.0-or-later
"""Check released wheels without running them: names, contents, and each module's processor, symbols and libraries.

    python release/check_wheel.py WHEEL...
"""

import io
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import libcxx
import lief
from platforms import PLATFORMS, PYTHONS, digits, python_tag, wheel_name

ROOT = Path(__file__).resolve().parent.parent
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
lief.logging.disable()
MODULES = ("_core", "_mesh")
NEWEST_GLIBC = (2, 28)
OLDEST_MACOS = [11, 0, 0]
LINUX_LIBRARIES = re.compile(r"lib(c|m|dl|rt|pthread)\.so\.\d+|ld-linux-[a-z0-9-]+\.so\.\d+")
WINDOWS_LIBRARIES = re.compile(r"(kernel32|ntdll|advapi32|api-ms-win-[a-z0-9-]+)\.dll", re.IGNORECASE)
MACOS_LIBRARIES = re.compile(r"/usr/lib/libSystem\.B\.dylib")
# zig's linker cannot hide symbols in libraries of macOS. Its loader looks up each symbol in one library only, so the
# names of Embree meet no others. Only weak definitions are shared by all libraries: here operator new and delete, which
# call malloc and free everywhere.
MACOS_EMBREE = re.compile(r"__ZN6embree\w+")
MACOS_WEAK = re.compile(r"__Z(n|d)(a|w|l)\w+")
PYTHON_NAME = re.compile(r"__?Py\w+")
FLAT_LOOKUP = -2


def module_faults(data, platform, python, module):
    """What is wrong with a compiled module, as sentences."""
    binary = lief.parse(io.BytesIO(data))
    system = platform.name.partition("-")[0]
    check = {"linux": _elf_faults, "windows": _windows_faults, "macos": _macos_faults}[system]
    return [f"{module}: {fault}" for fault in check(binary, platform, python, module)]


def _elf_faults(binary, platform, python, module):
    machine = {"linux-x64": lief.ELF.ARCH.X86_64, "linux-arm64": lief.ELF.ARCH.AARCH64}[platform.name]
    if not isinstance(binary, lief.ELF.Binary) or binary.header.machine_type != machine:
        yield f"not a module of {platform.name}"
        return
    yield from _foreign(binary.libraries, LINUX_LIBRARIES)
    for needed in binary.symbols_version_requirement:
        for version in needed.get_auxiliary_symbols():
            numbers = re.fullmatch(r"GLIBC_([\d.]+)", version.name)
            if not numbers or tuple(map(int, numbers[1].split("."))) > NEWEST_GLIBC:
                yield f"needs {version.name}, newer than glibc {'.'.join(map(str, NEWEST_GLIBC))}"
    exported = {symbol.name for symbol in binary.exported_symbols if symbol.name}
    yield from _exports(exported, f"PyInit_{module}")


def _windows_faults(binary, platform, python, module):
    if not isinstance(binary, lief.PE.Binary) or binary.header.machine != lief.PE.Header.MACHINE_TYPES.AMD64:
        yield f"not a module of {platform.name}"
        return
    libraries = [library.name for library in binary.imports]
    own = f"python{digits(python)}.dll"
    if own not in libraries:
        yield f"does not import {own}"
    yield from _foreign([name for name in libraries if name != own], WINDOWS_LIBRARIES)
    yield from _exports({entry.name for entry in binary.get_export().entries}, f"PyInit_{module}")


def _macos_faults(binary, platform, python, module):
    binary = binary.at(0) if isinstance(binary, lief.MachO.FatBinary) else binary
    if not isinstance(binary, lief.MachO.Binary) or binary.header.cpu_type != lief.MachO.Header.CPU_TYPE.ARM64:
        yield f"not a module of {platform.name}"
        return
    command = binary.build_version or binary.version_min
    oldest = list(command.minos if binary.build_version else command.version)
    if oldest > OLDEST_MACOS:
        yield f"needs macOS {oldest}, newer than {OLDEST_MACOS}"
    needed = [library.name for library in binary.libraries
              if library.command != lief.MachO.LoadCommand.TYPE.ID_DYLIB]
    yield from _foreign(needed, MACOS_LIBRARIES)
    exported = {symbol.name for symbol in binary.exported_symbols if not _may_be_exported(symbol)}
    yield from _exports(exported - {"__mh_dylib_header", "___dso_handle"}, f"_PyInit_{module}")
    yield from _macos_bind_faults(binary)
    # Apple's processors run no module without a signature; the linker makes one.
    if not binary.has_code_signature:
        yield "has no signature"


def _macos_bind_faults(binary):
    weak, flat = set(), set()
    for bind in binary.bindings:
        name = bind.symbol.name if bind.has_symbol else "a symbol without a name"
        if isinstance(bind, lief.MachO.DyldBindingInfo) and bind.binding_class == lief.MachO.DyldBindingInfo.CLASS.WEAK:
            weak.add(name)
        elif not bind.has_library and bind.library_ordinal in (FLAT_LOOKUP, FLAT_LOOKUP & 0xFF):
            flat.add(name)
    foreign = sorted(filter(libcxx.may_be_the_systems, weak))
    if foreign:
        yield f"{len(foreign)} weak binds may meet the system's libc++: {', '.join(foreign)}"
    other = sorted(name for name in flat if not PYTHON_NAME.fullmatch(name))
    if other:
        yield f"looks up {len(other)} symbols in all libraries that are not Python's: {', '.join(other)}"


def _may_be_exported(symbol):
    """True for a symbol of macOS that meets no symbol of another library."""
    weak = symbol.export_info.has(lief.MachO.ExportInfo.FLAGS.WEAK_DEFINITION)
    return (MACOS_WEAK if weak else MACOS_EMBREE).fullmatch(symbol.name) is not None


def _foreign(libraries, allowed):
    return [f"needs the library {name}" for name in libraries if not allowed.fullmatch(name)]


def _exports(names, entry):
    if entry not in names:
        yield f"does not export {entry}"
    prefix = entry[:entry.index("PyInit_") + 7]  # _core has a second entry, PyInit_core_bindings
    others = sorted(name for name in names if not name.startswith(prefix))
    if others:
        yield f"exports {len(others)} symbols beside {entry}, such as {others[0]}"


def wheel_faults(path):
    """What is wrong with a wheel, as sentences."""
    for platform in PLATFORMS:
        for python in PYTHONS:
            if path.name == wheel_name(VERSION, platform, python):
                with zipfile.ZipFile(path) as opened:
                    faults = _contents_faults(opened, platform, python)
                return faults + (_auditwheel_faults(path) if platform.name.startswith("linux") else [])
    return [f"the name is none of lamina {VERSION} for a platform and a Python of release/platforms.py"]


def _contents_faults(opened, platform, python):
    names = opened.namelist()
    faults = []
    end = platform.module_end(python)
    expected = {f"lamina/{module}{end}": module for module in MODULES}
    compiled = {name for name in names if re.search(r"\.(so|pyd|dylib|dll|a|lib|exe)$", name)}
    faults += [f"lacks {name}" for name in sorted(set(expected) - compiled)]
    faults += [f"holds {name}, which is not of this platform and Python" for name in sorted(compiled - set(expected))]
    info = f"lamina-{VERSION}.dist-info"
    for name in ("LICENSE", "THIRD_PARTY.md"):
        if f"{info}/licenses/{name}" not in names:
            faults.append(f"lacks {info}/licenses/{name}")
    tag = f"Tag: {python_tag(python)}-{python_tag(python)}-{platform.tag}"
    if [line for line in opened.read(f"{info}/WHEEL").decode().splitlines() if line.startswith("Tag:")] != [tag]:
        faults.append(f"its file WHEEL does not say {tag}")
    for name in sorted(set(expected) & compiled):
        faults += module_faults(opened.read(name), platform, python, expected[name])
    return faults


def _auditwheel_faults(path):
    finished = subprocess.run([sys.executable, "-m", "auditwheel", "show", path], capture_output=True, text=True)
    text = " ".join(finished.stdout.split())
    found = re.search(r'following platform tag: "manylinux_(\d+)_(\d+)_', text)
    if finished.returncode != 0 or not found or (int(found[1]), int(found[2])) > NEWEST_GLIBC:
        return [f"auditwheel does not find manylinux_2_28: {text or finished.stderr}"]
    return []


def main(paths):
    wrong = 0
    for path in map(Path, paths):
        faults = wheel_faults(path)
        wrong += bool(faults)
        print(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB, " + ("; ".join(faults) or "right"), flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
