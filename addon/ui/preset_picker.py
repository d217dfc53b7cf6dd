# SPDX-License-Identifier: GPL-3.0-or-later
"""The library's presets by picture: those of a category, or those that a search finds. The picture opens a
list of pictures, and a click on one of them applies its preset."""

from pathlib import Path

import bpy
import bpy.utils.previews
from bpy.props import EnumProperty, PointerProperty, StringProperty

from ..base import messages, native
from ..editing import over_material, presets

FOLDER = Path(__file__).resolve().parents[1] / "pictures"
SUFFIX = ".jpg"
_NONE = [("NONE", "None", "There is no such preset", 0, 0)]

_pictures = None  # Blender's collection of previews, while the add-on is registered
_items = {}  # items by category and search. Kept, because Blender does not copy the texts of an enumeration
_chosen = 0  # the number of the picture that was clicked last
_over = {}  # {session_uid of a material: the artist's choice of what of a preset is used}
_refusal = (None, "")  # the material of the last click, and why the preset was refused


def pictured():
    """The ids of all presets that have a picture."""
    return {path.stem for path in FOLDER.glob(f"*{SUFFIX}")}


def _by_category():
    try:
        return presets.by_category()
    except (native.NativeMissingError, ValueError):
        return {}


def _categories(_picker, _context):
    if "" not in _items:
        _items[""] = [(name, name[:1].upper() + name[1:], f"{len(entries)} presets", number)
                      for number, (name, entries) in enumerate(_by_category().items())]
    return _items[""] or _NONE


def _presets(picker, _context):
    """The presets of the category; while something is searched for, those of all categories whose names
    contain each of the words. A preset has the same number in all lists."""
    words = picker.search.casefold().split()
    key = (picker.category, *words)
    if key not in _items:
        library = [(category, one) for category, found in _by_category().items() for one in found]
        _items[key] = [
            (one.id, one.name or one.id, one.source, _icon(one.id), number)
            for number, (category, one) in enumerate(library)
            if (all(word in f"{one.name} {one.id}".casefold() for word in words) if words
                else category == picker.category)
        ]  # fmt: skip
    return _items[key] or _NONE


def _number(picker):
    """The number of the picture that is shown: the one clicked last, if it is in the list."""
    numbers = [item[-1] for item in _presets(picker, None)]
    return _chosen if _chosen in numbers else numbers[0]


def _choose(_picker, number):
    global _chosen
    _chosen = number


def _apply(picker, _context):
    """A click on a picture: apply the preset and show it, as an undo step. Blender shows no report of an
    operator that Python calls: the panel shows it."""
    global _refusal
    _refusal = (None, "")
    if bpy.ops.lamina.preset_apply.poll():
        try:
            bpy.ops.lamina.preset_apply("INVOKE_DEFAULT", True, preset=picker.preset, over=picker.over)
        except RuntimeError as error:
            _refusal = (bpy.context.material.session_uid, messages.reported(error))


def over(material):
    """What of a preset is used for `material`: "OVER" or "ALL"."""
    return _over.get(material.session_uid) or ("OVER" if over_material.is_over(material) else "ALL")


def can_lie_over(material):
    """True if there is something over which the layers of a preset can lie."""
    return material.lamina.enabled or not over_material.problem(material)


def _get_over(_picker):
    material = getattr(bpy.context, "material", None)
    return 1 if material is not None and over(material) == "ALL" else 0


def _set_over(_picker, number):
    material = getattr(bpy.context, "material", None)
    if material is not None:
        _over[material.session_uid] = presets.OVER[number][0]


def refusal(material):
    """Why the last click on a picture could not change `material`, in a sentence, or ''."""
    return _refusal[1] if _refusal[0] == material.session_uid else ""


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
    search: StringProperty(
        name="Search",
        description="Show the presets of all categories whose names contain these words",
        options={"TEXTEDIT_UPDATE"},
    )
    over: EnumProperty(
        name="What", description="What of a preset is used", items=presets.OVER, get=_get_over, set=_set_over)
    preset: EnumProperty(
        name="Preset",
        description="Click to see all pictures of the list. A click on one of them applies its preset",
        items=_presets, get=_number, set=_choose, update=_apply,
    )  # fmt: skip


def draw(layout, context):
    """The category, the search and the picture."""
    picker = context.window_manager.lamina_picker
    column = layout.column(align=True)
    row = column.row(align=True)
    if not picker.search:
        row.prop(picker, "category", text="")
    row.prop(picker, "search", text="", icon="VIEWZOOM")
    if context.material is not None and can_lie_over(context.material):
        column.row(align=True).prop(picker, "over", expand=True)
    if _presets(picker, context) is _NONE:
        column.label(text="No preset has this name" if picker.search else "The library is not available")
    else:
        picture = column.column()
        picture.active = bpy.ops.lamina.preset_apply.poll()
        picture.template_icon_view(picker, "preset", show_labels=True, scale=6.0, scale_popup=5.0)


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
    _over.clear()
