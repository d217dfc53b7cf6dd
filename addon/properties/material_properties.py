# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of a material: its layers, its base, and the report of its last bake.

The running bake and the last failure are not stored in the .blend: see bake_job.
"""

import json

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..base import changes
from ..base.preferences import CLOSURE_BASES, QUALITIES
from ..kinds.spectra import ILLUMINANT
from . import interior_properties
from .described import option
from .interior_properties import LaminaInterior
from .layer_properties import LaminaBase, LaminaDepth, LaminaLayer

# 1: media of three phase functions on four bases; 2: numbers of the bake's report as single properties
SCHEMA = 3


DEPTHS = (
    ("SURFACE", "Surface", "Light leaves where it enters: for layers thinner than the details"),
    ("SOFT", "Soft", "Light leaves beside where it enters, on a thick body of the same layers everywhere"),
    ("EXACT", "Exact", "Light is followed through the shape of the active object, which one medium fills"),
    ("VEINS", "Veins", "Light is followed through the active object, which two materials fill"),
)
TANGENTS = (
    ("UV", "UV Map", "Brushed along u of the active UV map"),
    ("X", "Around X", "Turned on a lathe: brushed in circles about the object's X axis"),
    ("Y", "Around Y", "Turned on a lathe: brushed in circles about the object's Y axis"),
    ("Z", "Around Z", "Turned on a lathe: brushed in circles about the object's Z axis"),
)
AUTOMATIC = "AUTO"  # the first of LATERAL_OUTPUTS
LATERAL_OUTPUTS = (
    (
        AUTOMATIC,
        "Automatic",
        "The first of the others that is at most 5 % off on the active object under the present lamps: walks "
        "through the object tell",
        3,
    ),
    (
        "RELIGHTABLE",
        "Mean Distance",
        "Subsurface Scattering nodes whose light leaves in the right amount at the right mean distance",
        0,
    ),
    (
        "PORTAL",
        "Full Profile",
        "A table of where light leaves, by Ray Portal closures: the whole profile, for closed meshes "
        "that are several times thicker than the mean exit distance",
        1,
    ),
    (
        "VOLUME",
        "Volume",
        "Cycles' volume rendering of one homogeneous medium: right for all closed shapes, also of deforming "
        "meshes and instances, and noisy",
        2,
    ),
)


class LaminaResult(bpy.types.PropertyGroup):
    """The last finished bake."""

    stack_hash: StringProperty(description="Hash of the stack that was baked; empty before the first bake")
    version: StringProperty(description="Of the Lamina that made the bake; empty in files of 0.1.0")
    quality: StringProperty()
    basis: StringProperty(description="Empty in older files, whose basis is standard")
    report_json: StringProperty(description="The report of lamina.bake, without single slices")
    curves: StringProperty(
        description="JSON: curves of the result's picture, see result_curves; empty without a picture"
    )

    @property
    def report(self):
        """The report of lamina.bake, see Lut.report; empty before the first bake."""
        return json.loads(self.report_json or "{}")

    def note(self, lut):
        """Keep the report of a finished lamina.Lut."""
        self.stack_hash, self.version = lut.header["stack_hash"], lut.header.get("version", "")
        self.quality, self.basis = lut.header["quality"], lut.header["basis"]
        kept = {name: value for name, value in lut.report.items() if not name.startswith("slice_errors")}
        if lut.uncovered is not None:
            kept["uncovered"] = {name: lut.uncovered.report[name] for name in ("fit_error", "worst_slice")}
        self.report_json = json.dumps(kept)


class LaminaMaterial(bpy.types.PropertyGroup):
    enabled: BoolProperty(description="This material has a layer stack")
    schema: IntProperty(description="Version of these properties; 0 before the first use")
    layers: CollectionProperty(type=LaminaLayer)
    active_index: IntProperty(name="Active Layer", options=set())
    base: PointerProperty(type=LaminaBase)
    about: StringProperty(description="JSON of an imported stack's texts: name, category, source")
    quality: EnumProperty(
        name="Quality",
        description="Accuracy of the bake. While layers change, Preview is shown",
        items=QUALITIES,
        default="final",
        update=changes.wished,
        options=set(),
    )
    basis: EnumProperty(
        name="Fit",
        description="How many lobes of Cycles the material has. While layers change, Standard is shown",
        items=CLOSURE_BASES,
        default="standard",
        update=changes.wished,
        options=set(),
    )
    tangent: EnumProperty(
        name="Tangent",
        description="The direction from which the angle of anisotropic surfaces counts. A link to the node's "
        "input Tangent comes before it",
        items=TANGENTS,
        update=changes.turned,
        options=set(),
    )
    illuminant: option(ILLUMINANT)
    result: PointerProperty(type=LaminaResult)
    node_group: PointerProperty(type=bpy.types.NodeTree, description="The node group that bakes update")
    depth: EnumProperty(
        name="Depth", description="How light below the surface is shown", items=DEPTHS, options=set()
    )
    lateral: EnumProperty(
        name="Shown By",
        description="How light that enters at one place and leaves at another is shown",
        items=LATERAL_OUTPUTS,
        default="RELIGHTABLE",  # of files in which no artist has chosen
        options=set(),
    )
    lateral_orders: IntProperty(
        name="Scatterings",
        description="Number of first scatterings that Cycles' volume computes for the portal. Few render in "
        "less time and with less noise, many show more of the sun's direction on curved bodies. 0: 1 to 14, "
        "more the stronger the forward scattering",
        min=0,
        max=14,
        default=0,
        options=set(),
    )
    lateral_group: PointerProperty(type=bpy.types.NodeTree, description="The node group of that light")
    lateral_report: StringProperty(description="What the last lateral node group promises, as one sentence")
    lateral_shown: StringProperty(description="The output that the last lateral node group shows")
    lateral_layers: StringProperty(
        description="What that node group was made from, see lateral_job.made_from; empty in files of 0.1.0"
    )
    lateral_scatterings: IntProperty(
        description="Scatterings that the lateral nodes leave to Cycles' volume rendering; 0 for none, "
        "and in files of 0.1.0"
    )
    interior: PointerProperty(type=LaminaInterior)
    trial: StringProperty(description="What the last trial of the nodes on show has found, as one sentence")


CLASSES = (*interior_properties.CLASSES, LaminaDepth, LaminaLayer, LaminaBase, LaminaResult, LaminaMaterial)


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(CLASSES)


def register():
    _register_classes()
    bpy.types.Material.lamina = PointerProperty(type=LaminaMaterial, name="Lamina")


def unregister():
    del bpy.types.Material.lamina
    _unregister_classes()
