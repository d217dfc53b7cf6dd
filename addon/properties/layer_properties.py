# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of a layer and of the base: every number of the stack's JSON that the panel can edit.

Names, ranges, defaults and tooltips of the parts of a stack come from `kinds`. A .blend file stores the
number of a choice, and nothing of a property that was never set: numbers and defaults never change, new ones
are only added. No property can be animated, because a bake cannot follow an animation.
"""

import bpy
from bpy.props import FloatProperty, FloatVectorProperty, PointerProperty, StringProperty

from ..base import changes, decimals
from ..kinds import bases, boundaries, media, phases
from ..kinds import metals as metal_table
from ..kinds.fields import all_fields
from ..kinds.flakes import COAT, PEARL, Flakes
from ..kinds.layers import DESCRIBED
from ..stack_json import solved_colours
from .described import choice, entries, having, number, option, per_channel, quantities, switch, text

LAYER_KINDS = entries((media.ITEM, boundaries.Interface.item, *(cls.item for cls in DESCRIBED.values())))
MODES = entries(form.item for form in media.FORMS)
PHASES = entries(cls.item for cls in phases.IN_PANEL)
BASES = entries((bases.NONE, *(cls.item for cls in bases.IN_PANEL)))


@having(quantities(field for cls in phases.IN_PANEL for field in cls.fields))
class PhaseProperties:
    """A phase function. `phase_text`, if not empty, is the JSON of a phase function that the panel cannot
    edit."""

    phase: choice(
        "Phase Function", PHASES, "How a particle spreads the light that it scatters", phases.USUAL.kind
    )
    phase_text: StringProperty(
        name="Imported Phase Function",
        description="JSON, as it was imported",
        update=changes.edited,
        options=set(),
    )


def _roughness(name, label, tip):
    """The property that shows the width `name` of facets as Blender's Roughness."""

    def set_alpha(owner, value):
        setattr(owner, name, max(decimals.shortest(value) ** 2, owner.bl_rna.properties[name].hard_min))

    return FloatProperty(
        name=label,
        description=tip,
        min=0.0,
        max=1.0,
        step=1,
        precision=3,
        subtype="FACTOR",
        get=lambda owner: getattr(owner, name) ** 0.5,
        set=set_alpha,
        options=set(),
    )


@having({one.name: option(one) for one in boundaries.FACETS})
class FacetProperties:
    """A rough surface. Stacks hold `alpha`; the panel shows its square root, Blender's Roughness."""

    alpha: number(boundaries.ALPHA)
    roughness: _roughness(
        "alpha",
        "Roughness",
        "0 is smooth; as in Blender's own shaders, the square root of the microfacet width",
    )
    anisotropic: switch(
        "Anisotropic",
        "The surface is brushed: its roughness differs along and across. For Blender 5.0 and newer",
    )
    alpha_v: number(boundaries.ALPHA_V)
    roughness_v: _roughness(
        "alpha_v",
        "Roughness Across",
        "Roughness across the tangent; Roughness is that along it. Brushed metal is rougher across its "
        "scratches",
    )
    angle: number(boundaries.ANGLE)


def _kind_changed(layer, _context):
    layer.varying = False
    changes.edited(layer)


def _varying_changed(layer, _context):
    """At most one medium or layer of flakes, and one interface, vary: the last choice wins."""
    if layer.varying:
        for other in layer.id_data.lamina.layers:
            covers = {"interface"} & {other.kind, layer.kind}
            if other != layer and other.varying and (not covers or other.kind == layer.kind):
                other.varying = False
    changes.edited(layer)


def _graded_changed(layer, _context):
    """The bottom starts like the top: values of the top are copied to all properties that were never set
    there."""
    if layer.graded:
        for prop in layer.bottom.bl_rna.properties:
            name = prop.identifier
            if not prop.is_readonly and name != "name" and not layer.bottom.is_property_set(name):
                setattr(layer.bottom, name, getattr(layer, name))
    changes.edited(layer)


@having(quantities(field for form in media.FORMS for field in form.local))
class MediumProperties(PhaseProperties):
    """The scattering properties of a medium at one depth."""

    shown_colour: FloatVectorProperty(
        name="Shown",
        description="The color of this medium, infinitely thick, under diffuse light",
        size=3,
        subtype="COLOR",
        get=lambda medium: solved_colours.thick_colour(medium) or (0.0, 0.0, 0.0),
        options=set(),
    )


class LaminaDepth(MediumProperties, bpy.types.PropertyGroup):
    """The bottom of a medium that changes with depth."""


@having(quantities((*(field for cls in DESCRIBED.values() for field in all_fields(cls)), *COAT)))
class LaminaLayer(MediumProperties, FacetProperties, bpy.types.PropertyGroup):
    name: StringProperty(
        name="Name", description="Name of this layer", default="Layer", options=set()
    )
    kind: choice("Kind", LAYER_KINDS, "What this layer is", update=_kind_changed)
    # An interface
    ior: number(boundaries.IOR)
    ior_per_channel: switch("IOR per Channel", "Give red, green and blue a refractive index of their own")
    ior_rgb: per_channel(boundaries.IOR, "Refractive index in red, green and blue")
    # A medium
    mode: choice("Described By", MODES, "Which numbers describe the medium", media.USUAL_FORM.item.id)
    over_given: switch("Seen Over", "The color is what this layer, as thick as it is, shows over a base")
    over: number(media.OVER)
    graded: switch(
        "Changes with Depth",
        "Give the bottom of this layer numbers of its own; what lies between is a blend",
        update=_graded_changed,
    )
    bottom: PointerProperty(type=LaminaDepth)
    profile_text: StringProperty(
        name="Imported Profile", description="JSON, as it was imported", update=changes.edited, options=set()
    )
    tau: number(media.TAU)
    tau_per_channel: switch("Per Channel", "Give red, green and blue an optical thickness of their own")
    tau_rgb: per_channel(media.TAU, "Optical thickness in red, green and blue")
    infinite: switch("Infinite", "This layer has no bottom; nothing below it is seen")
    thickness: number(media.THICKNESS)
    # Flakes
    flake_form: choice(
        "Flakes of", entries(form.item for form in Flakes.forms), "What the flakes are made of"
    )
    pearl: option(PEARL)
    coats_text: StringProperty(
        name="Imported Films", description="JSON, as it was imported", update=changes.edited, options=set()
    )
    varying: switch(
        "Varying",
        "Give the node group an input: of a medium, flakes or fibers the Thickness, from 0 to this layer's "
        "optical thickness; of an interface the Coverage, from 0 without it and its media to 1. "
        "One medium or layer of flakes or fibers, and one interface of a stack can vary",
        update=_varying_changed,
    )
    dusted: switch("Dusted", "Dust These Objects has added this layer")  # in no panel


def _gold():
    """{property: R, G, B} of gold, in both forms: the first numbers of a base that becomes a metal."""
    entry = metal_table.table()["gold"]
    facing, grazing = entry["facing"], entry["grazing"]
    pairs = [metal_table.indices(*pair) for pair in zip(facing, grazing, strict=True)]
    eta, k = zip(*pairs, strict=True)
    return {"facing": facing, "grazing": grazing, "eta": eta, "k": k}


def _base_kind_changed(base, context):
    """Defaults of properties never change, so the first metal of a base is set here."""
    if base.kind == bases.Conductor.kind:
        numbers = _gold()
        if not any(base.is_property_set(name) for name in (bases.Conductor.form_prop, *numbers)):
            base.metal_form = "colours"
            for name, value in numbers.items():
                setattr(base, name, value)
    changes.edited(base, context)


def _base_choices(cls):
    """{name: property} of a kind of base: its choices, without those of facets."""
    found = {one.name: option(one) for one in cls.options if one not in boundaries.FACETS}
    if cls.form_prop:
        items = entries(form.item for form in cls.forms)
        tip = f"Which numbers describe the {cls.item.label.lower()}"
        found[cls.form_prop] = choice("Described By", items, tip)
    return found


@having(quantities(one for cls in bases.IN_PANEL for fields in (cls.fields, *cls.forms) for one in fields))
@having({name: made for cls in bases.IN_PANEL for name, made in _base_choices(cls).items()})
class LaminaBase(PhaseProperties, FacetProperties, bpy.types.PropertyGroup):
    kind: choice("Base", BASES, "What lies below the layers", bases.Lambert.kind, update=_base_kind_changed)
    measured_name: text("Measured Material", "Name of the file from which the base was read")
