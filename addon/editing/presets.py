# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: the library that comes with `lamina`, and stacks that the user has saved.

A preset of the user is a stack's JSON file, named like the preset, in the folder of `user_folder`. The menu
lists the files without reading them, so a broken file does not hide the others.
"""

from ..base import native, package, preferences
from ..base.messages import RefusedError
from ..kinds import preset_files
from ..kinds.errors import StackError
from ..nodes import detail_wiring
from . import over_material, stack_io

FILMS = {"rain-drops": "DROPS", "puddles": "PUDDLES", "fingerprints": "PRINTS"}  # patterns of presets
TANGENTS = {"turned-brass": "Z"}  # of anisotropic presets that are not brushed along u of the UV map
OVERLAYS = "Overlays"  # the category of layers without a base, which lie over any material
OVER = (
    ("OVER", "Over My Material", "Only the preset's layers, over what the material shows"),
    ("ALL", "All of It", "The preset's layers, and what is below them"),
)


def by_category():
    """{category: [entry]} of the library, OVERLAYS first. Raises NativeMissingError."""
    categories = {OVERLAYS: []}
    for entry in _read(lambda library: library.entries()):
        categories.setdefault(entry.category, []).append(entry)
    return {name: entries for name, entries in categories.items() if entries}


def entry(preset):
    """The library's entry of this id, or None. Raises NativeMissingError."""
    return next((one for one in _read(lambda library: library.entries()) if one.id == preset), None)


def lies_over(material, entry, over=None):
    """True if `material` would get only the layers of a preset of the library, over what it shows: its nodes,
    or the base of its layers. `over`: the artist's choice. None: True if the layers lie over the material's
    own nodes now. Overlays always lie over."""
    if entry.category == OVERLAYS:
        return True
    return over_material.is_over(material) if over is None else over


def apply(material, preset, over=None):
    """Replace the layers by those of the library, and the base, unless the preset `lies_over` the material.
    Raises ValueError, NativeMissingError."""
    one = entry(preset)
    if one is None:
        raise RefusedError(f"preset = {preset}: there is no such preset")
    sentence = problem(material, one, over)
    if sentence:
        raise RefusedError(sentence)
    if lies_over(material, one, over):
        if not material.lamina.enabled:
            over_material.add(material)
        over_material.assign_layers(material, one.stack)
    else:
        stack_io.assign_stack(material, one.stack)
        if one.stack.is_oriented:
            material.lamina.tangent = TANGENTS.get(preset, "UV")
    if preset in FILMS or one.stack.varying is not None:
        material[detail_wiring.WANTED] = FILMS.get(preset, True)  # an even layer would look like clay


def can_be_shown(entry):
    """False for an anisotropic preset in a Blender that cannot show it."""
    return preferences.shows_anisotropy() or not entry.stack.is_oriented


def problem(material, entry, over=None):
    """A sentence on why a preset of the library cannot be applied to `material`, or '' if it can. Without a
    material (None) there is no reason. `over`: see lies_over."""
    if material is None:
        return ""
    if not can_be_shown(entry):
        return "Anisotropic surfaces need Blender 5.0 or newer"
    if not lies_over(material, entry, over):
        return ""
    sentence = over_material.layers_problem(entry.stack)
    return sentence if sentence or material.lamina.enabled else over_material.problem(material)


def user_folder(create=False):
    """The folder of the user's presets: that of the environment variable LAMINA_PRESETS, as in Python, or the
    extension's own. Raises OSError if it cannot be made."""
    shared = preset_files.shared_folder()
    if shared is None:
        return package.user_folder("presets", create)
    if create:
        shared.mkdir(parents=True, exist_ok=True)
    return shared


def user_names():
    """Names of the user's presets, sorted; empty if the folder cannot be read."""
    try:
        return preset_files.names_in(user_folder())
    except OSError:
        return []


def apply_user(material, name):
    """Like `apply` without a choice, with a preset of the user. Raises StackError, OSError, RefusedError."""
    stack = native.require().Stack.load(str(_existing(name)))
    assign = over_material.assign_layers if over_material.is_over(material) else stack_io.assign_stack
    assign(material, stack)


def save_user(material, name, replace=False):
    """Save layers and base under this name, completely or not at all. Returns the name.

    Raises RefusedError for a bad or taken name, StackError, OSError, NativeMissingError.
    """
    try:
        name = preset_files.checked_name(name)
    except StackError as error:
        raise RefusedError(str(error)) from None
    taken = preset_files.same_name(name, user_names())
    if taken is not None and not replace:
        raise RefusedError(f"name = {name}: there is a preset of this name; choose another, or tick Replace")
    name = taken or name
    stack_io.to_stack(material).save(user_folder(create=True) / (name + preset_files.SUFFIX))
    return name


def delete_user(name):
    """Delete a preset of the user. Raises RefusedError, OSError."""
    _existing(name).unlink()


def _read(what):
    """what(library). Raises NativeMissingError, also when the files of the library are gone."""
    try:
        return what(native.part("presets"))
    except OSError as error:
        raise native.NativeMissingError(native.GONE) from error


def _existing(name):
    """The file of a listed preset. Operators pass names, which must not lead to other folders."""
    if name not in user_names():
        raise RefusedError(f"preset = {name}: you have no preset of this name")
    return user_folder() / (name + preset_files.SUFFIX)
