# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the type stubs of the compiled modules: python tools/make_stubs.py [FOLDER]

FOLDER: destination of _core.pyi and _mesh.pyi; default native/lamina. Describes the modules of the installed package.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MODULES = ("_core", "_mesh")
HEAD = "# SPDX-License-Identifier: GPL-3.0-or-later\n# Written by `make stubs` from the compiled module.\n"


def stub(module, folder):
    """The text of the stub of lamina.`module`; `folder` is for temporary files."""
    command = [sys.executable, "-m", "pybind11_stubgen", f"lamina.{module}", "-o", folder]
    done = subprocess.run(command, capture_output=True, text=True)
    written = Path(folder, "lamina", f"{module}.pyi")
    if done.returncode != 0 or not written.is_file():
        raise SystemExit(f"make_stubs: lamina.{module}: {done.stderr.strip().splitlines()[-1:]}")
    text = written.read_text(encoding="utf-8")
    # Replace types that the tool cannot name, and the version, which is defined in pyproject.toml.
    text = text.replace("| ...]", "| typing.Any]").replace("[...]", "[typing.Any]")
    text = re.sub(r"^__version__: str = .*$", "__version__: str", text, flags=re.MULTILINE)
    lines = [line.rstrip() for line in text.splitlines()]
    return HEAD + "\n".join(lines).strip() + "\n"


def main():
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "native/lamina"
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for module in MODULES:
            (target / f"{module}.pyi").write_text(stub(module, folder), encoding="utf-8")


if __name__ == "__main__":
    main()
