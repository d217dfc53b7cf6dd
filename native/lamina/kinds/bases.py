# SPDX-License-Identifier: GPL-3.0-or-later
"""Bases: the surface or medium below the layers. A stack without a base is a thin sheet.

To add a base, write its class here, with its name in __all__, KINDS and IN_PANEL, and its reflection in the core."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as member

from .boundaries import ALPHA, FACETS, ORIENTATION
from .fields import Channels, Field, Form, Option, Rare, channel
from .hashable import Hashable
from .measured import TableText, table_of
from .media import ALBEDO, SIGMA_A, SIGMA_S, single_scattering_albedo
from .metals import METAL
from .panel import Item, Panel
from .phases import Isotropic, PhaseFunction

__all__ = ["Black", "Conductor", "HalfSpace", "Lambert", "Measured", "PrincipledBase", "Retroreflector", "ShaderBase"]


# A bake solves facets narrower than this as mirrors, and only their closure has their width: see solver.sharp_facets.
# The coat of a Principled material is always solved as a mirror.
LEAST_ALPHA = 0.03


def _one_number(name: str, high: float, default: float, label: str, tip: str, low: float = 0.0) -> Field:
    """A quantity of a Principled material that is the same in all channels."""
    return Field(name, low, high, single=True, panel=Panel(
        label, tip, default, step=1, precision=3, prop=f"principled_{name}", words=label.lower().replace("ior", "IOR")))


class Base(Hashable):
    """A kind of base. `fields`: quantities that always describe it; `forms`: alternative sets of quantities, of which
    one is given; `options`: choices; `rare`: quantities that JSON usually omits; `item`: its entry in the panel's list.
    `has_phase`: the base is a medium, with a member `phase`. `shown`: the quantity that Cycles takes in red, green and
    blue, as an input of the node group or for a BSDF, if any."""

    kind = ""
    fields: tuple[Field, ...] = ()
    forms: tuple[Form, ...] = ()
    options: tuple[Option | TableText, ...] = ()
    rare: tuple[Rare, ...] = ()
    item: Item
    has_phase = False
    shown = ""
    # Name of the add-on's property that selects the form; each form has an item.
    form_prop = ""

    def in_channel(self, index: int) -> tuple:
        """(name, parameters...) of one channel: the core's function that makes the base, and its arguments."""
        return (self.kind, *(channel(getattr(self, quantity.name), index) for quantity in self.fields))


@dataclass(frozen=True)
class Lambert(Base):
    """An ideally diffuse surface of the given reflectance, [0, 1]. `textured`: the baked material has an input for the
    reflectance, and this is the input's default."""

    reflectance: Channels
    textured: bool = False

    kind = "lambert"
    fields = (Field("reflectance", 0.0, 1.0, panel=Panel(
        "Reflectance", "Share of the light that the surface reflects, per channel", 0.5, rgb=True, subtype="COLOR")),)
    options = (Option("textured", (False, True), "Base Color from Input",
                      "Give the node group a base color input, for a texture; bakes take longer"),)
    item = Item(kind, "Diffuse Surface", "A matte opaque surface of the given color", 1)

    @property
    def shown(self) -> str:  # type: ignore[override]
        return "reflectance" if self.textured else ""


@dataclass(frozen=True)
class Conductor(Base):
    """A metal: its complex refractive index `eta` + i `k`, or two colours from which the stack computes the index:
    `facing`, the reflectance at normal incidence, and `grazing`, the reflectance at 82 degrees from the normal, both in
    [0, 1] and in air. Numbers, or one per channel. Or `metal`, a name of lamina.metals: the index is the published one,
    and the stack has wavelengths, see Stack. For the facets see Interface."""

    eta: Channels | None = None
    k: Channels | None = None
    alpha: float = 0.0
    distribution: str = "ggx"
    compensate: bool = True
    correlated: bool = True
    facing: Channels | None = None
    grazing: Channels | None = None
    alpha_v: float | None = None
    angle: float = 0.0
    metal: str | None = None

    kind = "conductor"
    # The panel's defaults must never change: .blend files do not store unchanged values.
    forms = (
        Form((
            Field("eta", 1e-3, 100.0, panel=Panel(
                "Index n", "Real part of the refractive index", (0.2141, 0.4547, 1.332), precision=3, rgb=True,
                words="index n")),
            Field("k", 0.0, 100.0, panel=Panel(
                "Extinction k", "Imaginary part of the refractive index", (3.251, 2.406, 1.869), precision=3, rgb=True,
                words="extinction k")),
        ), Item("indices", "Index", "By the complex refractive index, per channel", 0)),
        Form((
            Field("facing", 0.0, 1.0, panel=Panel(
                "Facing", "What the metal reflects straight back", (0.929, 0.77, 0.403), rgb=True, subtype="COLOR",
                words="facing color")),
            Field("grazing", 0.0, 1.0, panel=Panel(
                "Grazing", "What the metal reflects at a grazing view, 82 degrees", (0.946, 0.875, 0.677), rgb=True,
                subtype="COLOR", words="grazing color")),
        ), Item("colours", "Colors", "By the colors that it shows facing and grazing", 1)),
        Form((METAL,), Item("spectrum", "Spectrum", "By the published index of a metal at each wavelength", 2)),
    )
    form_prop = "metal_form"
    fields = (ALPHA,)
    options = FACETS
    rare = ORIENTATION
    item = Item(kind, "Metal", "A metal, by its refractive index or by its colors", 4)


@dataclass(frozen=True)
class Black(Base):
    """Absorbs all light."""

    kind = "black"
    item = Item(kind, "Black", "A surface that absorbs all light", 2)

    def in_channel(self, index: int) -> tuple:
        return Lambert.kind, 0.0


@dataclass(frozen=True)
class HalfSpace(Base):
    """An infinitely thick medium, given by `albedo`, in [0, 1], or by `sigma_s` and `sigma_a`, in 1/mm, which also
    determine how far light travels sideways. Numbers, or one per channel."""

    albedo: Channels | None = None
    phase: PhaseFunction = member(default_factory=Isotropic)
    sigma_s: Channels | None = None
    sigma_a: Channels | None = None

    kind = "half-space"
    forms = (
        Form((ALBEDO,), Item("optical", "Albedo", "By albedo", 0)),
        Form((SIGMA_S, SIGMA_A), Item("coefficients", "Per mm", "By scattering and absorption per millimetre", 1)),
    )
    form_prop = "half_space_form"
    has_phase = True
    item = Item(kind, "Deep Medium", "A medium without bottom: soil, snow, thick paint", 3)

    def albedo_of(self, index: int) -> float:
        """The albedo of one channel."""
        if self.albedo is not None:
            return channel(self.albedo, index)
        return single_scattering_albedo(channel(self.sigma_s, index), channel(self.sigma_a, index))

    def in_channel(self, index: int) -> tuple:
        """The black surface below the infinite medium, which no light reaches."""
        return Lambert.kind, 0.0


@dataclass(frozen=True)
class PrincipledBase(Base):
    """The surface that Cycles' Principled BSDF renders with these values, by the names and ranges of its sockets:
    `color` (Base Color, linear), `metallic`, `roughness` (the square root of the microfacet width), `ior`, `specular`
    (IOR Level; .5 leaves the index unchanged), `coat` (weight), `coat_roughness` and `coat_ior`. All other sockets have
    their defaults, and the facets are multiscatter GGX. `color` is a number or one per channel, the others are numbers.
    `inputs`: names among INPUTS that are sockets of the baked node group, and whose numbers are the sockets' defaults.

    Below an Interface, the indices are relative to the medium above the base; a smaller index than that of the medium
    counts as equal, because the law would reflect more light than it gets. Source of the law: Cycles 4.5."""

    color: Channels = 0.8
    metallic: float = 0.0
    roughness: float = 0.5
    ior: float = 1.5
    specular: float = 0.5
    coat: float = 0.0
    coat_roughness: float = 0.03
    coat_ior: float = 1.5
    inputs: tuple[str, ...] = ()

    kind = "principled"
    shown = "color"
    fields = (
        Field("color", 0.0, 1.0, panel=Panel(
            "Base Color", "Color of the diffuse light, or of the metal facing the viewer", 0.8, rgb=True,
            subtype="COLOR", prop="principled_color", words="base color")),
        _one_number("metallic", 1.0, 0.0, "Metallic", "0 is a dielectric, 1 is a metal"),
        _one_number("roughness", 1.0, 0.5, "Roughness", "Microfacet roughness: 0 is a mirror"),
        _one_number("ior", 4.0, 1.5, "IOR", "Index of refraction, which sets the specular reflection", low=1.0),
        _one_number("specular", 1.0, 0.5, "IOR Level",
                    "Changes the specular reflection: 0 is none, 0.5 is that of the IOR, 1 is twice as much"),
        _one_number("coat", 1.0, 0.0, "Coat Weight", "Strength of a clear coat on top of the material"),
        _one_number("coat_roughness", 1.0, 0.03, "Coat Roughness", "Microfacet roughness of the coat"),
        _one_number("coat_ior", 4.0, 1.5, "Coat IOR", "Index of refraction of the coat", low=1.0),
    )
    options = (Option("inputs", (), "Inputs", "Values that the node group gets as sockets, for textures", (
        Item("color", "Base Color", "Give the node group a Base Color socket", 1),
        Item("metallic", "Metallic", "Give the node group a Metallic socket", 2),
        Item("roughness", "Roughness", "Give the node group a Roughness socket", 4)), several=True),)
    distribution = "ggx"
    item = Item(kind, "Principled", "The surface that Blender's Principled BSDF shows with these values", 5)

    @property
    def alpha(self) -> float:
        """The width of the facets in a solve of all azimuth orders: 0 for a mirror in place of narrow facets."""
        alpha = self.roughness**2
        return alpha if alpha >= LEAST_ALPHA else 0.0

    def below(self, ior_above: float, index: int, all_facets: bool = False) -> tuple:
        """Like in_channel, below a medium of this index. `all_facets`: with facets however narrow."""
        alpha = self.roughness**2 if all_facets else self.alpha
        return (self.kind, channel(self.color, index), self.metallic, self.roughness, max(1.0, self.ior / ior_above),
                self.specular, self.coat, self.coat_roughness, max(1.0, self.coat_ior / ior_above), alpha)


@dataclass(frozen=True)
class ShaderBase(Base):
    """A surface that another shader renders: the baked node group has an input for the shader. Only the mean
    `reflectance` of the surface, [0, 1], is known, which is the default of another input. The group shows the
    layers' own light exactly, and the shader's light with a weight that gives the right energy on average: see
    lamina.bake. The solver takes the surface as a Lambert surface."""

    reflectance: Channels = 0.5

    kind = "shader"
    shown = "reflectance"
    fields = (Field("reflectance", 0.0, 1.0, panel=Panel(
        "Base Reflectance", "Mean share of the light that the shader below reflects: light that the layers throw back "
        "to the shader depends on the share", 0.5, rgb=True, subtype="COLOR", prop="shader_reflectance")),)
    item = Item(kind, "Other Shader (Approximate)", "The shader of your own nodes, seen through the layers: right in "
                "energy on average, not in each direction", 6)

    def in_channel(self, index: int) -> tuple:
        return Lambert.kind, channel(self.reflectance, index)


@dataclass(frozen=True)
class Measured(Base):
    """A measured isotropic material. `table`: its reflection, a text that lamina.measurements.load_base makes from a
    file, grey or red, green and blue. `name`: a text for the user, not part of the hash.

    The table is a function of the two directions in the medium above the base: below an Interface the light is taken to
    be reflected at the same angles as in air."""

    table: str = ""
    name: str = ""

    kind = "measured"
    options = (TableText("table", "Measured File", "The reflection of the material, as it was read from a file"),)
    item = Item(kind, "Measured", "A measured material, from a file of MERL or RGL", 7)

    @property
    def channels(self) -> int:
        """The number of channels of the table, 1 or 3."""
        return len(table_of(self.table))

    def in_channel(self, index: int) -> tuple:
        table = table_of(self.table)
        return self.kind, *table[index if len(table) > 1 else 0]


@dataclass(frozen=True)
class Retroreflector(Base):
    """A surface that sends light back where it came from, as glass beads and prisms do: road signs, reflective tape. It
    reflects the share `reflectance` of the light, in [0, 1], a number or one per channel, at all angles. `alpha`: the
    width of the lobe about the direction of the light, [.03, 1], one number.

    The lobe is that of GGX facets, see Interface, whose reflected light is turned by half a turn about the normal.
    Source of the lobe: the back vector of Belcour, Pacanowski, Delahaie, Laville-Geay and Eupherte 2014, "Bidirectional
    reflectance distribution function measurements and analysis of retroreflective materials"."""

    reflectance: Channels
    alpha: float = 0.1

    kind = "retroreflector"
    fields = (
        Field("reflectance", 0.0, 1.0, panel=Panel(
            "Color", "Share of the light that the surface sends back, per channel", 0.8, rgb=True, subtype="COLOR",
            prop="retro_reflectance", words="color of the retroreflector")),
        Field("alpha", LEAST_ALPHA, 1.0, single=True, panel=Panel(
            "Spread", "How far the light strays from its way back: 0.03 is reflective tape, 0.2 a worn sign", 0.1,
            soft_high=0.5, step=1, precision=3, prop="retro_alpha", words="spread of the retroreflector")),
    )
    distribution = "ggx"
    item = Item(kind, "Retroreflector", "Sends light back where it came from: road signs, reflective tape", 8)


NONE = Item("none", "None (Thin Sheet)", "Nothing below: light also leaves through the back", 0)
KINDS = (Lambert, Black, HalfSpace, Conductor, PrincipledBase, ShaderBase, Measured, Retroreflector)
# In this order, after NONE
IN_PANEL = (Lambert, Conductor, Retroreflector, Measured, PrincipledBase, ShaderBase, Black, HalfSpace)
BASES = {cls.kind: cls for cls in KINDS}
