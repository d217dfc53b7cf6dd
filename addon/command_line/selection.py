# SPDX-License-Identifier: GPL-3.0-or-later
"""Which files, materials and objects the arguments of a command select."""

import fnmatch
import glob
import os
from pathlib import Path

import bpy

from ..base import editable, messages, rendered
from ..base.messages import RefusedError
from .exit_codes import UsageError

SUFFIX = ".blend"


def split(names):
    """(the names and patterns of files, the others)."""
    files = [name for name in names if name.lower().endswith(SUFFIX)]
    return files, [name for name in names if name not in files]


def files(names):
    """The absolute paths of these files and patterns, without duplicates, in the order of the arguments.
    Raises UsageError."""
    chosen = {}
    for name in names:
        found = (
            [name]
            if os.path.isfile(name)
            else sorted(filter(os.path.isfile, glob.glob(name, recursive=True)))
        )
        if not found:
            raise UsageError(f"no file matches {name!r}")
        for path in found:
            chosen.setdefault(os.path.realpath(path), Path(os.path.abspath(path)))
    return list(chosen.values())


def open_file(path):
    """Open a .blend, with its workspaces, which a save would lose otherwise. Raises RefusedError."""
    try:
        result = bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=True)
        words = "" if "FINISHED" in result else "Blender cancelled"
    except RuntimeError as error:
        words = messages.reported(error) or "Blender names no reason"
    if words:
        raise RefusedError(f"{path} cannot be opened: {words}")


def targets(files, arguments):
    """Where each file is saved to: {file: path}, empty if nothing is to be saved. The file None is the open
    one. Raises UsageError."""
    output = arguments.output
    if arguments.save:
        if None in files and not bpy.data.filepath:
            raise UsageError("--save: no .blend file is open")
        return {file: Path(file or bpy.data.filepath).resolve() for file in files}
    if output is None:
        return {}
    if files != [None] and output.is_dir():
        return _in_folder(files, output.resolve())
    if len(files) > 1:
        raise UsageError(f"--output {output}: must be a folder, because there are {len(files)} files")
    if output.suffix != SUFFIX:
        raise UsageError(f"--output {output}: must end in .blend")
    if not output.resolve().parent.is_dir():
        raise UsageError(f"--output {output}: there is no such folder")
    return {files[0]: output.resolve()}


def _in_folder(files, folder):
    found = {file: (folder / file.name).resolve() for file in files}
    places = list(found.values())
    twice = next((place.name for place in places if places.count(place) > 1), None)
    if twice is not None:
        raise UsageError(f"--output {folder}: two files have the name {twice}")
    return found


def materials(names, with_stack):
    """(the materials of the open file that the names and patterns select, {name: why it selects nothing}),
    without duplicates, in the order of the names. `with_stack`: patterns select materials with layers
    only."""
    everything = list(bpy.data.materials)
    if not names:
        chosen = [one for one in everything if one.lamina.enabled and editable.is_editable(one)]
        return chosen, {} if chosen else {"": "no material of this file has Lamina layers"}
    chosen, missed = [], {}
    for name in names:
        exact = [one for one in everything if one.name == name]
        found = exact or [one for one in everything if fnmatch.fnmatchcase(one.name, name)]
        if not found:
            missed[name] = f"no material matches {name!r}"
        elif not exact:
            found = [
                one for one in found if editable.is_editable(one) and (one.lamina.enabled or not with_stack)
            ]
            if not found:
                missed[name] = f"no material that matches {name!r} has Lamina layers"
        chosen += [one for one in found if one not in chosen]
    return chosen, missed


def objects(names):
    """The mesh objects of the scene that the names or patterns select, without duplicates; without names, all
    that renders show. Raises UsageError."""
    if not names:
        return [one for one in rendered.shown(bpy.context.view_layer) if one.type == "MESH"]
    meshes = [one for one in bpy.context.scene.objects if one.type == "MESH"]
    chosen = []
    for name in names:
        exact = [one for one in meshes if one.name == name]
        found = exact or [one for one in meshes if fnmatch.fnmatchcase(one.name, name)]
        if not found:
            raise UsageError(f"no mesh object of the scene matches {name!r}")
        chosen += [one for one in found if one not in chosen]
    return chosen
