# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of a benchmark that runs in Blender, with the extension installed."""

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "demo_scenes"))

import extension  # noqa: E402
import output  # noqa: E402


def main(name, description, numbers, measure, argv=None):
    """Run `measure(..., say)`, and store the rows that it returns in build/bench/NAME.json. `numbers`: whole numbers
    that `measure` takes, by name, with their initial values; each is an option of the command line."""
    parser = argparse.ArgumentParser(description=description)
    for option, value in numbers.items():
        parser.add_argument(f"--{option}", type=int, default=value)
    parser.add_argument("--extension", type=Path, help="extension zip (default: the newest in build/extension/)")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "bench" / f"{name}.json")
    arguments = vars(parser.parse_args(argv))
    zip_path, out = arguments.pop("extension") or extension.newest_zip(ROOT / "build/extension"), arguments.pop("out")
    with extension.isolate():
        import bpy  # noqa: F401 - reads the environment that isolate() sets

        with extension.installed(zip_path):
            rows = measure(**arguments, say=lambda text: print(f"{name}: {text}", flush=True))
    output.save_json(out, rows)
    return 0
