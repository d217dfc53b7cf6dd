# SPDX-License-Identifier: GPL-3.0-or-later
"""zig's C++ library with an inline namespace of our own, for macOS.

There, dyld looks up some symbols of C++ (vtables, templates of streams) by name in all loaded libraries, also where a
module has its own. The system's libc++ has the namespace std::__1, as zig's has: a module would use parts of both. zig
compiles its library from source, so that another namespace in the library's first header is in all of its names.
"""

import re
import shutil
from pathlib import Path

HEADER = "libcxx/include/__config"
GUARD = "#define _LIBCPP___CONFIG\n"
DEFINED = "_LIBCPP_ABI_NAMESPACE"  # zig defines it by an option
OWN = "__lamina"  # release/macos-arm64.cmake states it too, so that Embree is compiled again when it changes
# Mangled names in std::__1, or in std without an inline namespace.
_SYSTEMS = re.compile(rf"\w*St3__1\w*|__Z(T[VTISC]|GV|GR)?(NK?)?St(?!{len(OWN)}{OWN})\w*")


def may_be_the_systems(name):
    """True for the mangled name of a symbol that the libc++ of macOS may define too."""
    return _SYSTEMS.fullmatch(name) is not None


def namespace(toolchain):
    """The namespace that a toolchain file of CMake states, or None."""
    found = re.search(r"^set\(libcxx_namespace (\w+)\)$", Path(toolchain).read_text(encoding="utf-8"), re.M)
    return found and found[1]


def make(zig_library, folder, own):
    """Makes `folder` zig's library folder with the inline namespace `own`: links to all other files."""
    text = Path(zig_library, HEADER).read_text(encoding="utf-8")
    if text.count(GUARD) != 1:
        raise SystemExit(f"release: {HEADER} of this zig does not begin as expected: no namespace of our own")
    text = text.replace(GUARD, f"{GUARD}#undef {DEFINED}\n#define {DEFINED} {own}\n")
    header = Path(folder, HEADER)
    if header.is_file() and header.read_text(encoding="utf-8") == text and header.resolve() == header.absolute():
        return
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(zig_library, folder, copy_function=lambda source, target: Path(target).symlink_to(source))
    header.unlink()
    header.write_text(text, encoding="utf-8")
