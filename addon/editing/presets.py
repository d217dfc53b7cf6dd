# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: the library that comes with `lamina`, and stacks that the user has saved.

A preset of the user is a stack's JSON file, named like the preset, in the extension's user folder. The menu
lists the files without reading them, so a broken file does not hide the others.
"""



from ..base import native, package
from ..base.messages import RefusedError
from . import over_material, stack_io

SUFFIX = ".json"
LONGEST = 60
FORBIDDEN = '/\\:*?"<>|'
RESERVED = {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}


def by_category():
    """{category: [entry]} of the library, in its own order. Raises NativeMissingError."""
    categories = {}
    for entry in _read(lambda library: library.entries()):
        categories.setdefault(entry.category, []).append(entry)
    return categories


def entry(preset):
    """The library's entry of this id, or None. Raises NativeMissingError."""
    return next((one for one in _read(lambda library: library.entries()) if one.id == preset), None)


def apply(material, preset):
    """Replace the layers and base by those of the library; the base of layers that lie over the material's
    own nodes stays. Raises ValueError, NativeMissingError."""
    if entry(preset) is None:
        raise RefusedError(f"preset = {preset}: there is no such preset")
    _assign(material, _read(lambda library: library.load(preset)))


def user_folder(create=False):
    """The folder of the user's presets. Raises OSError if it cannot be made."""
    return package.user_folder("presets", create)


def user_names():
    """Names of the user's presets, sorted; empty if the folder cannot be read."""
    try:
        found = [path.stem for path in user_folder().iterdir() if path.suffix == SUFFIX and path.is_file()]
    except OSError:
        return []
    return sorted((name for name in found if not name.startswith(".")), key=str.casefold)


def apply_user(material, name):
    """Like `apply`, with a preset of the user. Raises StackError, OSError, RefusedError."""
    _assign(material, native.require().Stack.load(str(_existing(name))))


def save_user(material, name, replace=False):
    """Save layers and base under this name, completely or not at all. Returns the name.

    Raises RefusedError for a bad or taken name, StackError, OSError, NativeMissingError.
    """
    name = checked_name(name)
    taken = next((one for one in user_names() if one.casefold() == name.casefold()), None)
    if taken is not None and not replace:
        raise RefusedError(f"name = {name}: there is a preset of this name; choose another, or tick Replace")
    name = taken or name
    stack_io.to_stack(material).save(user_folder(create=True) / (name + SUFFIX))
    return name


def delete_user(name):
    """Delete a preset of the user. Raises RefusedError, OSError."""
    _existing(name).unlink()


def checked_name(name):
    """The name, trimmed, if it can be a file's name everywhere. Raises RefusedError."""
    name = " ".join(name.split())
    if not 1 <= len(name) <= LONGEST:
        raise RefusedError(f"name has {len(name)} characters: must have 1 to {LONGEST}")
    for character in name:
        if character in FORBIDDEN or not character.isprintable():
            raise RefusedError(f"name = {name!r}: must not contain {character!r}")
    if name[0] == "." or name[-1] == "." or name.split(".")[0].casefold() in RESERVED:
        raise RefusedError(f"name = {name}: must not start or end with a stop, nor be a device's name")
    return name


def _assign(material, stack):
    assign = over_material.assign_layers if over_material.is_over(material) else stack_io.assign_stack
    assign(material, stack)


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
    return user_folder() / (name + SUFFIX)
