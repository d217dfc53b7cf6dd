# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the asset library: dist/lamina-assets.zip.

    python tools/build_assets.py [--output dist] [--quality preview|final] [--preset ID ...] [--extension ZIP]

The zip holds one .blend with all presets, baked and marked as assets, and the catalogue file of Blender. It works
without the add-on: unpack it and add the folder under Preferences > File Paths > Asset Libraries. Licence CC0: the
library holds numbers and pictures, no code.
"""

import argparse
import sys
import tempfile
import uuid
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "demo_scenes"))

import extension  # noqa: E402
import numpy as np  # noqa: E402

FOLDER, LIBRARY, CATALOGUES = "Lamina Materials", "lamina-materials.blend", "blender_assets.cats.txt"
NAMESPACE = uuid.UUID("5f1c7a52-2b4e-5c38-9f0e-6a8d4b1d7e20")  # catalogues keep their identity between versions
LICENCE = """The materials of this library are published under CC0 1.0:
https://creativecommons.org/publicdomain/zero/1.0/
Sources of the numbers are in the description of each asset.
"""


def build(output, quality, chosen=(), say=print):
    """The archive's path. `chosen`: ids of presets; all if empty. The add-on must be enabled."""
    # Blender reads the place of its profile when bpy is imported: after extension.isolate.
    import bpy

    import lamina

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    presets = extension.part("editing.presets")
    entries = [entry for entry in filter(presets.can_be_shown, lamina.presets.entries())
               if entry.category != presets.OVERLAYS  # have no base, so alone they are no materials
               and (entry.id in chosen or not chosen)]
    entries.sort(key=lambda entry: (entry.category, entry.name))
    for number, entry in enumerate(entries):
        _asset(entry, quality)
        say(f"{number + 1} of {len(entries)}: {entry.name}")
    archive = output / "lamina-assets.zip"
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="lamina-assets-") as scratch:
        folder = Path(scratch)
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / LIBRARY), compress=True)
        (folder / CATALOGUES).write_text(_catalogues({entry.category for entry in entries}), encoding="utf-8")
        (folder / "LICENSE.txt").write_text(LICENCE, encoding="utf-8")
        partial = archive.with_suffix(".part")
        with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as packed:
            for name in (LIBRARY, CATALOGUES, "LICENSE.txt"):
                packed.write(folder / name, f"{FOLDER}/{name}")
        partial.replace(archive)
    return archive


def _asset(entry, quality):
    """A baked material of a preset, marked as an asset with picture, catalogue, tags, source and licence."""
    import bpy

    presets, bake_job = extension.part("editing.presets"), extension.part("baking.bake_job")
    material = bpy.data.materials.new(entry.name)
    extension.part("nodes.node_tree").of(material)
    presets.apply(material, entry.id)
    material.lamina.quality = quality
    bake_job.bake_material(material)
    material.asset_mark()
    data = material.asset_data
    data.catalog_id, data.author, data.license = str(_catalogue(entry.category)), "Lamina", "CC0"
    data.description = entry.source
    for tag in ("Lamina", "layered", *entry.category.lower().replace(" and ", " ").split()):
        data.tags.new(tag, skip_if_exists=True)
    _set_picture(material, ROOT / "addon" / "pictures" / f"{entry.id}.jpg")


def _set_picture(material, path):
    import bpy

    image = bpy.data.images.load(str(path))
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    preview = material.preview_ensure()
    preview.image_size = image.size
    preview.image_pixels_float.foreach_set(pixels)
    bpy.data.images.remove(image)


def _catalogue(category):
    return uuid.uuid5(NAMESPACE, category)


def _catalogues(categories):
    lines = [f"{_catalogue(name)}:Lamina/{name}:Lamina-{name}" for name in sorted(categories)]
    return "\n".join(["VERSION 1", "", *lines, ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=ROOT / "dist", help="folder of the archive")
    parser.add_argument("--quality", choices=("preview", "final"), default="final", help="of the bakes")
    parser.add_argument("--preset", action="append", default=[], metavar="ID", help="only these presets")
    parser.add_argument("--extension", type=Path, help="extension zip (default: the newest in build/extension/)")
    arguments = parser.parse_args()
    archive = arguments.extension or extension.newest_zip(ROOT / "build/extension")
    with extension.isolate(), extension.installed(archive):
        print(build(arguments.output.resolve(), arguments.quality, arguments.preset))


if __name__ == "__main__":
    main()
