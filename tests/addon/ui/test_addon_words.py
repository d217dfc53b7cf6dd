# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of the panel: descriptions of everything that has a tooltip, units, no Greek letters."""

import re
from types import SimpleNamespace

import bpy
from addon_helpers import Layout, drawn, drawn_base, drawn_layer, icosphere, linked

GREEK = re.compile("[\u0370-\u03ff]|^(alpha|beta|eta|lambda|mu|sigma|tau)$", re.IGNORECASE)

ENGINE_ROOM = re.compile(
    r"\b(Fit|Preview|Final|Live|Lateral|Portal|Relightable|Lit|Phase|Varying|Between Rows)\b|^Base$")


def operators():
    for name in dir(bpy.ops.lamina):
        yield name, getattr(bpy.ops.lamina, name).get_rna_type()


def edited(addon):
    """The property groups with properties that a panel draws."""
    properties = addon.properties
    return (properties.layer_properties.LaminaDepth, properties.layer_properties.LaminaLayer,
            properties.layer_properties.LaminaBase, properties.dust_properties.LaminaDust,
            *properties.interior_properties.CLASSES, addon.base.preferences.LaminaPreferences)  # fmt: skip


def test_every_operator_and_each_of_its_properties_is_described(addon):
    silent = [name for name, rna in operators() if not rna.description]
    silent += [f"{name}.{prop.identifier}" for name, rna in operators() for prop in rna.properties
               if prop.identifier != "rna_type" and not prop.description]
    assert silent == [] and len(list(operators())) > 25


def test_every_property_in_a_panel_is_described(addon):
    silent = [f"{cls.__name__}.{prop.identifier}" for cls in edited(addon) for prop in cls.bl_rna.properties
              if prop.type not in ("POINTER", "COLLECTION")
              and prop.identifier not in ("rna_type", "name", "bl_idname") and not prop.description]
    assert silent == []


class Controls(Layout):
    """Counts what can be changed or clicked: a row of choices as one control, the buttons beside a list as a part of
    it, and nothing in folded parts. `headings`: of the folded parts."""

    def __init__(self):
        super().__init__()
        self.__dict__.update(controls=[], headings=[])

    def _inside(self, *_args, **_options):
        inside = Controls()
        inside.__dict__.update(lines=self.lines, controls=self.controls, headings=self.headings)
        return inside

    row = column = split = box = grid_flow = _inside

    def panel(self, name, default_closed=False):
        self.headings.append(name)
        return Layout(), None if default_closed else self._inside()

    def _add(self, name):
        if not self.controls or self.controls[-1] != name:
            self.controls.append(name)

    def prop(self, owner, name, text=None, **options):
        super().prop(owner, name, text, **options)
        self._add((name, text) if text else name)

    def prop_enum(self, owner, name, value, text=None, **options):
        super().prop_enum(owner, name, value, text, **options)
        self._add(name)

    def operator(self, name, text=None, icon="NONE", **options):
        if text != "":
            self._add(name)
        return super().operator(name, text, icon, **options)

    def menu(self, name, text=None, **options):
        super().menu(name, text, **options)
        if text != "":
            self._add(name)

    def template_list(self, cls, name, *what, **options):
        super().template_list(cls, name, *what, **options)
        self._add(cls)


def main_view(addon, material, obj, layout=None):
    """What all panels but Advanced draw. `layout`: in which to draw."""
    themes = bpy.context.preferences.themes
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0), themes=themes),
        region=SimpleNamespace(width=600),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get, object=obj,
        mode="OBJECT", material=material, engine="CYCLES",
        scene=bpy.context.scene, view_layer=bpy.context.view_layer, window_manager=bpy.context.window_manager,
    )  # fmt: skip
    panel, ui = addon.ui.panel, addon.ui
    every = (panel.LAMINA_PT_main, panel.LAMINA_PT_layers, ui.where_panel.LAMINA_PT_where, panel.LAMINA_PT_base,
             ui.depth_panel.LAMINA_PT_depth)
    draws = [cls.draw for cls in every if cls.wanted(material)]
    if layout is not None:
        layout.headings.extend(cls.__name__ for cls in every if cls.wanted(material))
        return [draw(SimpleNamespace(layout=layout), context) for draw in draws]
    return drawn(lambda layout: [draw(SimpleNamespace(layout=layout), context) for draw in draws])


def test_the_main_view_has_no_word_of_the_engine_room(addon, lamina, material, call):
    ball = linked("Ball", icosphere("Ball", 1.0))
    ball.data.materials.append(material)
    bpy.context.view_layer.objects.active = ball
    plain = bpy.data.materials.new("Plain")
    texts = main_view(addon, addon.nodes.node_tree.of(plain) and plain, ball)
    addon.editing.layer_list.add_layer(material, "interface")
    texts += main_view(addon, material, ball)
    for layer in (0, 1):
        material.lamina.active_index = layer
        call(bpy.ops.lamina.place, material, place="PAINTED")
        texts += main_view(addon, material, ball)
    material.lamina.active_index = 1
    call(bpy.ops.lamina.place, material, place="SETTLED")
    texts += main_view(addon, material, ball)
    material.lamina.layers[1].mode = "coefficients"
    for depth in ("SURFACE", "SOFT", "EXACT", "VEINS"):
        assert call(bpy.ops.lamina.depth, material, depth=depth) == {"FINISHED"}
        texts += main_view(addon, material, ball)
    for owner, name in ((material.lamina, "lateral"), (material.lamina.interior, "output")):
        texts += [item.name for item in owner.bl_rna.properties[name].enum_items]
    assert {"Albedo", "Roughness", "Settle Again", "Full Profile", "Lamps Stay", "Compute Interior"} <= set(texts)
    assert [text for text in texts if ENGINE_ROOM.search(text)] == []


def test_the_main_view_is_short(addon, lamina, material, call):
    """Advanced is one more heading."""
    ball = linked("Ball", icosphere("Ball", 1.0))
    ball.data.materials.append(material)
    bpy.context.view_layer.objects.active = ball
    addon.editing.layer_list.add_layer(material, "interface")
    material.lamina.active_index = 1
    counts = {}

    def count(name):
        layout = Controls()
        main_view(addon, material, ball, layout)
        counts[name] = len(layout.controls), sum(heading.startswith("LAMINA") for heading in layout.headings)

    for place in ("EVEN", "PAINTED", "SETTLED"):
        call(bpy.ops.lamina.place, material, place=place)
        count(place)
    call(bpy.ops.lamina.place, material, place="EVEN")
    material.lamina.layers[1].mode = "coefficients"
    for depth in ("SURFACE", "SOFT", "EXACT", "VEINS"):
        assert call(bpy.ops.lamina.depth, material, depth=depth) == {"FINISHED"}
        count(depth)
    assert max(headings for _, headings in counts.values()) <= 5, counts
    assert max(controls for controls, _ in counts.values()) <= 12, counts


def test_a_number_of_millimetres_says_so_in_its_label(addon, material):
    layer = material.lamina.layers[0]
    layer.mode = "coefficients"
    texts = drawn_layer(addon, layer)
    assert {"Scattering (1/mm) R", "Absorption (1/mm) R", "Thickness (mm)"} <= set(texts)
    for cls in edited(addon):
        for prop in cls.bl_rna.properties:
            if re.search(r"\b(in mm|in 1/mm|per mm|millimetres)\b", prop.description):
                assert "mm" in prop.name, f"{cls.__name__}.{prop.identifier}"


def test_no_label_is_a_greek_letter(addon, material):
    layer = material.lamina.layers[0]
    texts = drawn_base(addon, material.lamina.base)
    for phase in layer.bl_rna.properties["phase"].enum_items:
        layer.phase = phase.identifier
        texts += drawn_layer(addon, layer)
    assert [text for text in texts if GREEK.search(text)] == []
