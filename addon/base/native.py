# SPDX-License-Identifier: GPL-3.0-or-later
"""Access to the `lamina` package: the imported package, or one sentence with the reason why it is missing.

Nothing else in the add-on imports `lamina`, so that enabling the add-on works without it.
"""

import importlib
import importlib.util
import sys
import sysconfig
from pathlib import Path

REQUIRED = ("Stack", "bake", "lobes")

_package = None
_reason = "Lamina's native module has not been loaded yet"


GONE = "Lamina's files are gone: another Blender has removed or replaced them; start this Blender again"
REPLACED = "Another build of Lamina has been installed since Blender's start; start Blender again"


class NativeMissingError(RuntimeError):
    """The `lamina` package cannot be used here; str() is the one-sentence reason."""


def load():
    """Import `lamina`, or store the reason of the failure. Called whenever the add-on is enabled, so that a
    new wheel is found. A build that replaces a loaded one is refused: the old modules are still in memory."""
    global _package, _reason
    importlib.invalidate_caches()
    try:
        package = importlib.import_module("lamina")
        written = Path(package.__file__).stat().st_mtime_ns  # the unpacking of the wheel
        if package.__dict__.setdefault("_written", written) != written:
            _package, _reason = None, REPLACED
            return
        package.lobes = importlib.import_module("lamina.lobes")
        for name in REQUIRED:
            getattr(package, name)
    except Exception as error:  # A broken wheel may raise any error; the add-on must still be enabled.
        _package, _reason = None, _explain(error)
    else:
        _package, _reason = package, ""


def available():
    return _package is not None


def reason():
    """One sentence, or '' when `lamina` is there."""
    return _reason


def require():
    """The `lamina` package. Raises NativeMissingError."""
    if _package is None:
        raise NativeMissingError(_reason)
    return _package


def part(name):
    """A module of the `lamina` package that is not imported with it. Raises NativeMissingError."""
    package = require()
    try:
        return importlib.import_module(f"{package.__name__}.{name}")
    except ImportError as error:
        file = getattr(package, "__file__", None)
        if file is not None and not Path(file).is_file():
            raise NativeMissingError(GONE) from None
        raise NativeMissingError(f"Lamina's native module is too old: {_one_line(error)}") from None


def _explain(error):
    here = f"Python {sys.version_info.major}.{sys.version_info.minor}"
    found = _compiled_files()
    if isinstance(error, ImportError) and found is not None:
        suffix = sysconfig.get_config_var("EXT_SUFFIX") or ""
        if not found:
            return f"Lamina's native module is missing from its package: reinstall the extension for {here}"
        if not any(name.endswith(suffix) or ".abi3." in name for name in found):
            return f"Lamina's native module {found[0]} was built for another Python; this Blender runs {here}"
    if found is None:
        return f"Lamina's native module is not installed for {here}: install the extension made for it"
    return f"Lamina's native module does not load: {_one_line(error)}"


def _compiled_files():
    """Names of the compiled modules beside `lamina`, or None when there is no such package."""
    try:
        spec = importlib.util.find_spec("lamina")
    except (ImportError, ValueError):
        return None
    if spec is None or not spec.submodule_search_locations:
        return None
    folders = [Path(folder) for folder in spec.submodule_search_locations]
    return sorted(file.name for folder in folders for file in folder.glob("_core*") if file.is_file())


def _one_line(error):
    return " ".join(f"{type(error).__name__}: {error}".split())
