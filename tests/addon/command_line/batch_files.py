# SPDX-License-Identifier: GPL-3.0-or-later
"""Files for batches, what they hold afterwards, and batches in processes of their own."""

import subprocess
import sys
import textwrap

import bpy
import own_blender
import serialised_tree
from addon_helpers import image_of, pixels


def make(addon, path, taus):
    """A .blend with a material for each (name, tau): one layer of dust, preview quality; without layers for None."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for name, tau in taus.items():
        material = bpy.data.materials.new(name)
        material.use_fake_user = True
        addon.nodes.node_tree.of(material)
        if tau is not None:
            addon.editing.layer_list.add_stack(material)
            material.lamina.quality = "preview"
            material.lamina.layers[0].varying = False
            material.lamina.layers[0].tau = tau
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def held(path):
    """All that a batch could change in a .blend, without the seconds of bakes: {material: nodes, settings, pixels}."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    found = {}
    for material in bpy.data.materials:
        group = material.lamina.node_group
        result = material.lamina.result
        names = [prop.identifier for prop in result.bl_rna.properties
                 if prop.identifier not in ("rna_type", "report_json")]
        found[material.name] = (
            serialised_tree.of_material(material),
            {name: getattr(result, name) for name in names} | {"report": result.report | {"seconds": 0.0}},
            None if group is None else pixels(image_of(group)).tobytes(),
        )
    return found, serialised_tree.of_file()


def baked(path):
    """The names of the baked materials of a .blend on disk."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return {one.name for one in bpy.data.materials if one.lamina.result.stack_hash}


def in_another_process(*arguments, before=""):
    """A Popen of a batch in a Blender of its own; `before`: lines of Python that run first and may use `lamina`."""
    script = textwrap.dedent("""
        import os, signal, sys, time
        import bpy, addon_utils
        addon = addon_utils.enable({module!r}, default_set=True)
        lamina = addon.base.native.require()
        {before}
        code = addon.command_line.command.main({arguments!r})
        sys.stdout.flush(); sys.stderr.flush()
        os._exit(code)
    """)
    lines = "\n".join(textwrap.dedent(before).strip().splitlines())
    script = script.format(module=own_blender.MODULE, before=lines, arguments=[str(one) for one in arguments])
    return subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)  # fmt: skip
