# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs when Python starts under wine 8, as `sitecustomize`: what Python and numpy need and wine lacks.

Wine ends the program at a function that it lacks. Python has replacements for the management service and CopyFile2.
numpy needs functions of complex numbers: those of wine's C library, most of them stubs, get a jump to wine_math.dll.
"""

import _winapi
import ctypes
import sys
from pathlib import Path

NAMES = ("cabs", "carg", "ccos", "ccosh", "cexp", "cimag", "cpow", "creal", "csin", "csinh", "ctan", "ctanh")
READ_WRITE_EXECUTE = 0x40


def address_of(library, name):
    return ctypes.cast(getattr(library, name), ctypes.c_void_p).value


def replace_functions():
    kernel, wine = ctypes.WinDLL("kernel32"), ctypes.CDLL("ucrtbase")
    ours = ctypes.CDLL(str(Path(__file__).with_name("wine_math.dll")))
    for name in (name + end for name in NAMES for end in ("f", "", "l")):
        to = address_of(ours, "lamina_" + name).to_bytes(8, "little")
        jump = b"\x48\xb8" + to + b"\xff\xe0"  # mov rax, to; jmp rax: shorter than any stub or function of wine
        place = address_of(wine, name)
        if not kernel.VirtualProtect(ctypes.c_void_p(place), ctypes.c_size_t(len(jump)), READ_WRITE_EXECUTE,
                                     ctypes.byref(ctypes.c_ulong())):
            raise OSError(f"wine does not let its {name} be replaced")
        ctypes.memmove(place, jump, len(jump))


sys.modules["_wmi"] = None
vars(_winapi).pop("CopyFile2", None)
replace_functions()
