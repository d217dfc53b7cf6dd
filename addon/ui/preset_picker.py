# SPDX-License-Identifier: GPL-3.0-or-later
"""The library's presets by picture: a category, a picture that opens all of the category, and a button."""

from pathlib import Path

import bpy
import bpy.utils.previews
from bpy.props import EnumProperty, PointerProperty

from ..base import native
from ..editing import presets

FOLDER = Path(__file__).resolve().parents[1] / "pictures"
SUFFIX = ".jpg"
_NONE = [("NONE", "None", "The library is not available", 0, 0)]

_pictures = None  # Blender's collection of previews, while the add-on is registered
# Blender needs the texts of an enumeration to stay alive: lists of items by category, and the categories.
_items = {}
_CATEGORIES = None  # their key: no category is None


def pictured():
    """The ids of all presets that have a picture."""
    return {path.stem for path in FOLDER.glob(f"*{SUFFIX}")}


def _by_category():
    try:
        return presets.by_category()
    except (native.NativeMissingError, ValueError):
        return {}


def _categories(_settings, _context):
    if _CATEGORIES not in _items:
        _items[_CATEGORIES] = [(name, name[:1].upper() + name[1:], f"{len(entries)} presets", number)
                      for number, (name, entries) in enumerate(_by_category().items())]
    return _items[_CATEGORIES] or _NONE


def _presets(settings, _context):
    category = settings.category
    if category not in _items:
        found = _by_category().get(category, ())
        _items[category] = [(one.id, one.name or one.id, one.source, _icon(one.id), number)
                            for number, one in enumerate(found)]
    return _items[category] or _NONE


def _icon(preset):
    """The icon's number for the picture of a preset, loaded at the first use; 0 without a picture."""
    path = FOLDER / f"{preset}{SUFFIX}"
    if _pictures is None or not path.is_file():
        return 0
    if preset not in _pictures:
        _pictures.load(preset, str(path), "IMAGE")
    return _pictures[preset].icon_id


class LaminaPicker(bpy.types.PropertyGroup):
    category: EnumProperty(name="Category", description="A part of the library of presets", items=_categories)
    preset: EnumProperty(
        name="Preset", description="Click the picture to see all of this category", items=_presets
    )


def draw(layout, context):
    """The picker. The button replaces the layers of the material, with undo."""
    picker = context.window_manager.lamina_picker
    column = layout.column(align=True)
    column.prop(picker, "category", text="")
    column.template_icon_view(picker, "preset", show_labels=True, scale=6.0, scale_popup=5.0)
    entry = next((one for one in _presets(picker, context) if one[0] == picker.preset), _NONE[0])
    row = column.row()
    row.scale_y = 1.3
    row.operator("lamina.preset_apply", text=f"Use {entry[1]}", icon="CHECKMARK").preset = entry[0]


def register():
    global _pictures
    _pictures = bpy.utils.previews.new()
    bpy.utils.register_class(LaminaPicker)
    bpy.types.WindowManager.lamina_picker = PointerProperty(type=LaminaPicker, name="Lamina Presets")


def unregister():
    global _pictures
    del bpy.types.WindowManager.lamina_picker
    bpy.utils.unregister_class(LaminaPicker)
    bpy.utils.previews.remove(_pictures)
    _pictures = None
    _items.clear()
