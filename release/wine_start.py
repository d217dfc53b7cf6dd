# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs when Python starts under wine 8, as `sitecustomize`: what Python and numpy need and wine lacks.

Wine ends the program at a function that it lacks. Python has replacements for the management service and CopyFile2.
numpy needs functions of complex numbers: their stubs in wine's C library get a jump to those of wine_math.dll.
"""

import _winapi
import ctypes
import sys
from pathlib import Path

STUB = bytes.fromhex("4883ec28488d0d")  # how wine's stubs start; each is 24 bytes long
READ_WRITE_EXECUTE = 0x40


def address_of(library, name):
    return ctypes.cast(getattr(library, name), ctypes.c_void_p).value


def fill_stubs():
    kernel, wine = ctypes.WinDLL("kernel32"), ctypes.CDLL("ucrtbase")
    ours = ctypes.CDLL(str(Path(__file__).with_name("wine_math.dll")))
    stem = ("cabs", "carg", "cimag", "creal", "ccos", "ccosh", "cexp", "csin", "csinh", "ctan", "ctanh", "cpow")
    for name in (name + end for name in stem for end in ("f", "", "l")):
        stub = address_of(wine, name)
        if ctypes.string_at(stub, len(STUB)) != STUB:
            continue  # this wine has the function
        to = address_of(ours, "lamina_" + name).to_bytes(8, "little")
        jump = b"\x48\xb8" + to + b"\xff\xe0"  # mov rax, to; jmp rax
        before = ctypes.c_ulong()
        if not kernel.VirtualProtect(ctypes.c_void_p(stub), ctypes.c_size_t(len(jump)), READ_WRITE_EXECUTE,
                                     ctypes.byref(before)):
            raise OSError(f"wine does not let its stub of {name} be filled")
        ctypes.memmove(stub, jump, len(jump))


sys.modules["_wmi"] = None
vars(_winapi).pop("CopyFile2", None)
fill_stubs()
