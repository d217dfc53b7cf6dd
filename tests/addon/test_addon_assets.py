# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library: materials that another file can append and render, with catalogue, tags, picture and licence."""

import sys
import zipfile
from pathlib import Path

import bpy
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
CHOSEN = {"leaf": "Paper and leaves", "dusty-bronze": "Dust and weathering"}


@pytest.fixture
def library(addon, lamina, tmp_path, monkeypatch):
    """The folder of an unpacked library of the CHOSEN presets."""
    monkeypatch.setattr(sys, "path", [str(ROOT / "demo_scenes"), str(ROOT / "tools"), *sys.path])
    import build_assets

    archive = build_assets.build(tmp_path / "dist", "preview", tuple(CHOSEN), say=lambda text: None)
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(tmp_path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return tmp_path / build_assets.FOLDER


def test_materials_are_assets_with_all_that_a_browser_shows(addon, library, lamina):
    catalogues = {}
    for line in (library / "blender_assets.cats.txt").read_text(encoding="utf-8").splitlines()[2:]:
        number, path, _ = line.split(":")
        catalogues[number] = path
    with bpy.data.libraries.load(str(library / "lamina-materials.blend"), assets_only=True) as (there, here):
        here.materials = there.materials
    assert sorted(one.name for one in here.materials) == ["Dusty bronze", "Leaf"]
    for material in here.materials:
        entry = next(one for one in lamina.presets.entries() if one.name == material.name)
        data = material.asset_data
        assert catalogues[data.catalog_id] == f"Lamina/{CHOSEN[entry.id]}"
        assert (data.license, data.author, data.description) == ("CC0", "Lamina", entry.source)
        assert {"Lamina", entry.category.split()[0].lower()} <= {tag.name for tag in data.tags}
        assert material.lamina.result.stack_hash == entry.stack.hash
        has_detail = addon.nodes.detail_wiring.detail(material) is not None
        assert has_detail == (entry.id == "dusty-bronze")
        images = [node.image for node in material.lamina.node_group.nodes if node.type == "TEX_IMAGE"]
        assert images and all(image.packed_file for image in images)
        preview = np.empty(4 * np.prod(material.preview.image_size), np.float32)
        material.preview.image_pixels_float.foreach_get(preview)
        assert preview.std() > 0.05
    assert "CC0" in (library / "LICENSE.txt").read_text()
