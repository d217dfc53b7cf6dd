# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a bake relative to the layers, the quality and the basis in the panel."""

import pytest


@pytest.fixture
def told(addon):
    """told(material): the state that the panel shows, as one text."""
    return lambda material: addon.ui.state_line.told(material)[0]


@pytest.fixture
def listed(addon, lamina, capsys):
    """listed(): the output of `list` for the only material."""

    def listed():
        capsys.readouterr()
        assert addon.command_line.command.main(["list"]) == 0
        return capsys.readouterr().out.strip()

    return listed


BAKED = {"quality": "preview", "basis": "standard"}
OTHERS = {
    "better quality": ({}, {"quality": "final"}, "quality Preview instead of Final"),
    "better basis": ({}, {"basis": "accurate"}, "fit Standard instead of Accurate"),
    "both": ({}, {"quality": "final", "basis": "accurate"},
             "quality Preview instead of Final, fit Standard instead of Accurate"),
    "lower quality": ({"quality": "final"}, {}, "quality Final instead of Preview"),
    "lower basis": ({"basis": "accurate"}, {}, "fit Accurate instead of Standard"),
}  # fmt: skip


@pytest.mark.parametrize(("baked", "chosen", "sentence"), OTHERS.values(), ids=OTHERS)
def test_a_bake_at_other_settings_than_the_chosen_is_not_up_to_date(
    addon, lamina, material, told, listed, baked, chosen, sentence
):
    addon.baking.bake_job.bake_material(material, **(BAKED | baked))
    for name, value in (BAKED | baked).items():
        setattr(material.lamina, name, value)
    assert addon.baking.bake_job.state(material) == "fresh" and told(material) == "Up to date"
    assert listed() == "Bronze: 1 layer, up to date"
    for name, value in (BAKED | chosen).items():
        setattr(material.lamina, name, value)
    addon.baking.update.leave(material)
    assert addon.baking.bake_job.state(material) == "other"
    assert told(material) == f"Out of date: baked with {sentence}"
    assert listed() == f"Bronze: 1 layer, out of date, baked with {sentence}"
    material.lamina.layers[0].tau = 3.3
    assert addon.baking.bake_job.state(material) == "stale", "changed layers are told first"


def test_a_bake_without_a_word_of_its_basis_was_of_the_standard_one(addon, lamina, material):
    addon.baking.bake_job.bake_material(material)
    material.lamina.result.basis = ""
    assert addon.baking.bake_job.state(material) == "fresh"
    material.lamina.basis = "accurate"
    assert addon.baking.bake_job.state(material) == "other"


def test_a_bake_by_a_version_whose_results_have_changed_is_out_of_date(
    addon, lamina, material, told, listed, monkeypatch
):
    changes = addon.base.native.part("baking.report.result_changes")
    addon.baking.bake_job.bake_material(material)
    assert material.lamina.result.version == lamina.__version__
    monkeypatch.setattr(changes._core, "__version__", "0.3.0")
    table = [changes.Change("0.2.0", "dust", lambda stack: stack.varying is not None)]
    monkeypatch.setattr(changes, "CHANGES", table)
    material.lamina.layers[0].varying = False
    addon.baking.bake_job.bake_material(material)
    material.lamina.result.version = "0.1.0"
    assert addon.baking.bake_job.state(material) == "fresh", "the change does not concern this stack"
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    assert addon.baking.bake_job.state(material) == "fresh", "baked by the version that runs"
    material.lamina.result.version = "0.1.0"
    assert addon.baking.bake_job.state(material) == "older"
    assert told(material) == "Out of date: baked by 0.1.0; 0.2.0 changed dust"
    assert listed() == "Bronze: 1 layer, out of date, baked by 0.1.0; 0.2.0 changed dust"


def test_what_waits_for_its_update_is_told(addon, lamina, material, told, listed):
    addon.baking.bake_job.bake_material(material)
    material.lamina.layers[0].tau = 3.3
    assert told(material) == "The layers before the last change; the full one follows"
    material.lamina.quality = "final"
    addon.baking.bake_job.bake_material(material, "preview")
    assert told(material) == "A coarse picture of these layers; the full one follows"
    assert listed() == "Bronze: 1 layer, out of date, baked with quality Preview instead of Final"
    addon.baking.update.leave(material)
    assert told(material) == "Out of date: baked with quality Preview instead of Final"


def test_a_coarse_update_is_never_up_to_date(addon, lamina, material, told):
    job = addon.baking.update.UpdateJob(material, False, {"nodes": 8})
    job.wait(60.0)
    job.show(material, addon.baking.update._follow(material))
    addon.baking.update.leave(material)
    assert told(material) == "Out of date: baked with quality Coarse instead of Preview"


def test_a_table_whose_file_is_gone_is_not_up_to_date(addon, lamina, material, told, listed, tmp_path):
    addon.baking.bake_job.bake_material(material)
    nodes = material.lamina.node_group.nodes
    image = next(node.image for node in nodes if node.type == "TEX_IMAGE")
    image.packed_files[0].filepath = str(tmp_path / "table.exr")
    image.unpack(method="WRITE_ORIGINAL")
    assert image.packed_file is None and addon.baking.bake_job.state(material) == "fresh"
    (tmp_path / "table.exr").unlink()
    addon.baking.update.leave(material)
    assert addon.baking.bake_job.state(material) == "none"
    assert told(material) == "The nodes or the table of the last update are gone"
    assert listed() == "Bronze: 1 layer, the node group of the last bake is not whole"
