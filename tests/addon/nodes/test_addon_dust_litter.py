# SPDX-License-Identifier: GPL-3.0-or-later
"""Fibers and specks: single things in dust, with sizes in the world, and none on clean ground."""

import bpy
import numpy as np
import pytest
from mathutils import Euler
from test_addon_dust_detail import plane, shown

SIDE, PIXEL = 1000, 0.002  # of a picture, in metres
LENGTH, SIZE = 0.4, 0.03  # of fibers and specks


@pytest.fixture
def node(addon):
    """A node of detail without noise and litter, in dust of the thickness 0.5, on a square of 2 m."""
    material = bpy.data.materials.new("Dust")
    addon.nodes.node_tree.of(material)
    made = material.node_tree.nodes.new("ShaderNodeGroup")
    made.node_tree = addon.nodes.dust_detail.group()
    for name in ("Clouds", "Grain", "Fibers", "Specks"):
        made.inputs[name].default_value = 0.0
    made.inputs["Fiber Length"].default_value, made.inputs["Speck Size"].default_value = LENGTH, SIZE
    made.inputs["Thickness"].default_value = 0.5
    plane().data.materials.append(material)
    return made


@pytest.fixture
def litter(node, tmp_path):
    """litter(**inputs): a picture of the thickness beyond that of the dust."""

    def litter(**inputs):
        for name, value in inputs.items():
            node.inputs[name.replace("_", " ")].default_value = value
        material = bpy.data.materials["Dust"]
        found = shown(material, node.outputs["Thickness"], tmp_path / "litter.exr", SIDE)
        left = 1.0 - node.inputs["Wiped"].default_value
        return found - left * node.inputs["Thickness"].default_value

    return litter


def pieces(mask):
    """The connected pieces of a mask: arrays of pixels (n, 2)."""
    left, found = {tuple(one) for one in np.argwhere(mask)}, []
    while left:
        front, piece = [left.pop()], []
        while front:
            row, column = front.pop()
            piece.append((row, column))
            near = {(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)} & left
            left -= near
            front += near
        found.append(np.array(piece))
    return found


def lengths(found):
    return np.array([np.linalg.norm(np.ptp(one, axis=0) + 1.0) for one in found]) * PIXEL


def test_fibers_are_long_and_thin(litter):
    found = [one for one in pieces(litter(Fibers=1.0) > 0.3) if len(one) > 4]
    assert 10 < len(found) < 2.0**2 / LENGTH**2 * 1.5
    assert 0.5 * LENGTH < np.quantile(lengths(found), 0.9) < 1.1 * LENGTH
    # Strips of 5 mm, of which 4.7 mm are above the limit.
    assert np.median([len(one) * PIXEL**2 for one in found] / lengths(found)) == pytest.approx(0.0047, rel=0.15)
    assert len({tuple(np.ptp(one, axis=0) > 20) for one in found}) > 2, "they lie in different directions"


def test_specks_are_round_and_small(litter):
    found = [one for one in pieces(litter(Specks=1.0) > 1.0) if len(one) > 4]
    assert len(found) > 20
    spans = np.array([np.ptp(one, axis=0) + 1.0 for one in found])
    assert np.median(spans.max(axis=1) / spans.min(axis=1)) < 1.6
    sizes = PIXEL * spans.max(axis=1)
    assert np.median(sizes) < SIZE and np.quantile(sizes, 0.9) < 1.6 * SIZE


@pytest.mark.parametrize("name", ["Fibers", "Specks"])
def test_more_dust_and_a_larger_share_have_more_litter_on_top(litter, name):
    """Where litter lies in little dust, the same litter lies in more."""
    few, some, many = (litter(**{name: share}, Thickness=tau) for share, tau in ((0.3, 0.1), (0.3, 0.5), (1.0, 0.5)))
    for fewer, more in ((few, some), (some, many)):
        assert (fewer >= -1e-6).all() and fewer.max() <= 3.0 + 1e-6
        assert fewer.mean() < more.mean() and (more >= fewer - 1e-6).all()
    assert 0.001 < some.mean() / 0.5 < 0.2, "the dust's own thickness is most of the mean"


def test_clean_and_wiped_ground_has_no_litter(litter, node):
    assert not litter(Fibers=1.0, Specks=1.0, Thickness=0.0).any()
    assert not litter(Thickness=0.5, Wiped=1.0).any()
    assert litter(Wiped=0.0).max() > 2.0


def test_back_faces_have_litter_only_in_their_own_dust(node, litter, tmp_path):
    material = bpy.data.materials["Dust"]
    litter(Fibers=1.0, Specks=1.0)
    node.inputs["Thickness Back"].default_value = 0.0
    assert not shown(material, node.outputs["Thickness Back"], tmp_path / "back.exr", SIDE).any()
    node.inputs["Thickness"].default_value, node.inputs["Thickness Back"].default_value = 0.0, 0.5
    assert not shown(material, node.outputs["Thickness"], tmp_path / "front.exr", SIDE).any()
    assert shown(material, node.outputs["Thickness Back"], tmp_path / "back.exr", SIDE).max() > 2.0


@pytest.mark.parametrize("turn", [(1.5708, 0.0, 0.0), (0.0, 1.5708, 0.0), (0.7854, 0.0, 0.0)])
def test_fibers_are_not_stretched_on_sides(litter, turn):
    """Faces across x and y, and at 45 degrees."""
    thing, matrix = bpy.context.scene.objects["Square"], Euler(turn).to_matrix().to_4x4()
    thing.data.transform(matrix)
    thing.rotation_euler = matrix.inverted().to_euler()
    bpy.context.view_layer.update()
    found = [one for one in pieces(litter(Fibers=1.0) > 0.3) if len(one) > 4]
    assert len(found) > 10 and 0.4 * LENGTH < np.quantile(lengths(found), 0.9) < 1.5 * LENGTH


def test_nodes_of_earlier_versions_get_no_litter(addon):
    """Sockets that are added to a group of an earlier version leave the look of its nodes."""
    detail = addon.nodes.dust_detail
    group = detail.group()
    for item in [one for one in group.interface.items_tree if one.name in ("Fibers", "Specks")]:
        group.interface.remove(item)
    group[detail.MARK] = 3
    material = bpy.data.materials.new("Old")
    addon.nodes.node_tree.of(material)
    node = material.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    assert "Fibers" not in node.inputs and detail.group() == group
    assert node.inputs["Fibers"].default_value == node.inputs["Specks"].default_value == 0.0
