# SPDX-License-Identifier: GPL-3.0-or-later
"""Render the demos: `python demo_scenes/make_demo.py [SCENE|all] [--quality tiny|small|final]`.

A scene is a folder here with a demo.py. Its run(out, quality, stack_path, say) renders the scene, writes its files and
returns (files, verdict, True if all is well). Its OPTIONS are names of further arguments of run. Each scene is
announced when its files are written; the slab also announces the picture that needs no path-traced volume.
Exit code 0 if all scenes are well, otherwise 1.
"""

import argparse
import importlib
import sys
import time
from pathlib import Path

import extension

HERE = Path(__file__).resolve().parent
QUALITIES = ("tiny", "small", "final")


def scenes():
    """Names of the scenes: the slab, which takes least time, and then the others by name."""
    return sorted((path.parent.name for path in HERE.glob("*/demo.py")), key=lambda name: (name != "slab", name))


def make(names, quality="small", zip_path=None, out=HERE / "out", stack_path=None, say=print, options=None):
    """Render the scenes `names` with the extension of `zip_path`, in a separate Blender profile.

    options: values by name, for scenes that have such an option. Yields (files, verdict, True if all is well) after
    each scene. Raises extension.ExtensionMissingError.
    """
    zip_path = zip_path or extension.newest_zip(HERE.parent / "build/extension")
    out.mkdir(parents=True, exist_ok=True)
    with extension.isolate(), extension.installed(zip_path):
        for name in names:
            demo = importlib.import_module(f"{name}.demo")
            known = getattr(demo, "OPTIONS", ())
            more = {key: value for key, value in (options or {}).items() if key in known}
            yield demo.run(out, quality, stack_path, say, **more)


def main(argv=None):
    parser = argparse.ArgumentParser(description="Render demo scenes and check them against the truth.")
    parser.add_argument("scene", nargs="?", default="all", choices=["all", *scenes()])
    parser.add_argument("--except", dest="left_out", default=[], action="append", metavar="SCENE", choices=scenes(),
                        help="with all: leave this scene out")
    parser.add_argument("--quality", choices=QUALITIES, default="small")
    parser.add_argument("--stack", type=Path, help="a stack JSON in place of the scene's own")
    parser.add_argument("--mesh", type=Path, help="dragon: a PLY, OBJ or STL file in place of the dragon")
    parser.add_argument("--up", choices=("y", "z"), default="y", help="dragon: which axis is up in that file")
    parser.add_argument("--turntable", type=int, default=0, metavar="N",
                        help="dragon: also N frames of its turn; marble: N frames of a sun that goes around the dragon")
    parser.add_argument("--thumbnails", type=Path, metavar="DIR", help="presets: also a small picture of each into DIR")
    parser.add_argument("--overlays", action="store_true", help="presets: only each overlay over ten materials")
    parser.add_argument("--extension", type=Path, help="extension zip (default: the newest in build/extension/)")
    parser.add_argument("--out", type=Path, default=HERE / "out")
    arguments = parser.parse_args(argv)
    if arguments.turntable < 0:
        parser.error(f"--turntable {arguments.turntable}: must not be negative")
    start = time.perf_counter()
    all_well = True

    def say(text):
        print(f"[{time.perf_counter() - start:5.0f} s] {text}", flush=True)

    names = scenes() if arguments.scene == "all" else [arguments.scene]
    names = [name for name in names if name not in arguments.left_out]
    try:
        for files, verdict, well in make(
            names, arguments.quality, arguments.extension, arguments.out, arguments.stack, say,
            {"mesh": arguments.mesh, "up": arguments.up, "turntable": arguments.turntable,
             "thumbnails": arguments.thumbnails, "overlays": arguments.overlays},
        ):
            print(f"{' and '.join(_short(path) for path in files) or 'nothing'}: {verdict}", flush=True)
            all_well = all_well and well
    except (extension.ExtensionMissingError, ValueError, OSError, RuntimeError) as error:
        print(f"make_demo: {error}", file=sys.stderr)
        return 1
    return 0 if all_well else 1


def _short(path):
    path = Path(path).resolve()
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


if __name__ == "__main__":
    sys.exit(main())
