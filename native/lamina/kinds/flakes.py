# SPDX-License-Identifier: GPL-3.0-or-later
"""Flakes: layers of small mirrors that lie nearly flat, as in metallic and pearl paints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .bases import Conductor
from .fields import Channels, Field, Form, Option, channel
from .films import EXTINCTION, FILM_IOR, FILM_THICKNESS, Coats, Film
from .hashable import Hashable
from .panel import Item, Panel

# Narrower flakes need more azimuth orders than a solve tries.
LEAST_SPREAD = 0.1

AMOUNT = Field("tau", 0.0, 1e3, panel=Panel(
    "Amount", "Optical thickness of the flakes: 0.1 hides 10 % of what lies below, 1 hides 63 %, 3 hides 95 %", 1.0,
    soft_high=5.0, step=10, precision=3, words="amount of flakes", prop="flake_tau"))
SPREAD = Field("alpha", LEAST_SPREAD, 1.0, single=True, panel=Panel(
    "Spread", "How much the flakes are tilted: 0.1 lie flat and flash, 0.4 lie loosely", 0.2, soft_high=0.5, step=1,
    precision=3, words="spread of flakes", prop="flake_alpha"))
TINT = Field("binder", 0.0, 1e3, panel=Panel(
    "Tint", "Optical thickness of the dye between the flakes, per channel: 0 is clear", 0.0, soft_high=2.0, step=10,
    precision=3, rgb=True, words="tint between flakes", prop="flake_binder"))
REFLECTANCE = Field("reflectance", 0.0, 1.0, panel=Panel(
    "Flake Color", "What a flake reflects at all angles, per channel", (0.85, 0.86, 0.87), rgb=True, subtype="COLOR",
    words="color of flakes", prop="flake_reflectance"))
BY_COLOUR = Form((REFLECTANCE,), Item("colour", "Color", "Flakes that reflect this color at all angles: pearl", 0))
BY_METAL = Form(tuple(Conductor.forms[1]), Item(
    "metal", "Metal", "Flakes of a metal, by the colors that it shows facing and grazing", 1))
BY_SPECTRUM = Form(tuple(Conductor.forms[2]), Item(
    "spectrum", "Spectrum", "Flakes of a metal, by its published index at each wavelength", 2))
BY_INDEX = Form(tuple(Conductor.forms[0]), Item(
    "indices", "Index", "Flakes of a metal, by its complex refractive index, per channel", 3))
# Muscovite, Deer, Howie and Zussman 1992, An Introduction to the Rock-Forming Minerals: n_beta 1.58 to 1.61
MICA = 1.58
PLATELET = Field("ior", 1.0, 4.0, panel=Panel(
    "Platelet Index", "Refractive index of the platelets below their films: 1.58 is mica, 1.52 glass, 1.77 alumina",
    MICA, step=1, precision=3, words="index of platelets", prop="platelet_ior"))
BY_FILM = Form((PLATELET,), Item(
    "film", "Interference", "Clear platelets with a thin film on both faces, whose color turns with the angle", 4))
COATS = Coats("film")
# The one film of the panel
COAT_IOR = Field("ior", FILM_IOR.low, FILM_IOR.high, panel=Panel(
    "Film Index", "Refractive index of the film, real part: 2.5 is titanium dioxide", 2.5, step=1, precision=3,
    words="film index", prop="coat_film_ior"))
COAT_EXTINCTION = Field("k", EXTINCTION.low, EXTINCTION.high, panel=Panel(
    "Film Extinction", "Imaginary part of the film's refractive index: 0 is clear", 0.0, step=1, precision=3,
    words="film extinction", prop="coat_film_k"))
COAT_THICKNESS = Field("thickness", FILM_THICKNESS.low, FILM_THICKNESS.high, "nm", single=True, panel=Panel(
    "Film Thickness (nm)", "Thickness of the film on both faces of the flakes: of titanium dioxide, 50 is white, "
    "80 gold, 100 red, 125 blue, 150 green", 120.0, soft_high=300.0, step=100, precision=1,
    words="film thickness", prop="coat_film_thickness"))
COAT = (COAT_IOR, COAT_EXTINCTION, COAT_THICKNESS)
VARYING = Option("varying", (False, True), "Varying Thickness",
                 "Give the node group a Thickness input for the layer of flakes")

PEARL = Option("pearl", (False, True), "Pearl",
               "What the flakes do not reflect passes through them, as in mica; otherwise they absorb the rest")


@dataclass(frozen=True)
class Flakes(Hashable):
    """A layer of flakes, small mirrors whose normals are spread about the layer's normal. Light may be reflected by any
    number of them. Each quantity is a number or one per channel.

    Either `reflectance`, of a flake at all angles, in [0, 1], or a metal as a Conductor has it: by its two colours in
    air, `facing` and `grazing`, see lamina.metals.flakes; by its index, `eta` + i `k`; or by its name, `metal`. Its
    Fresnel factor is that in the binder. `pearl`: flakes with a `reflectance` pass straight what they do not reflect,
    instead of absorbing; metals always absorb. Or clear platelets of index `ior`, in [1, 4], which pass straight what
    they do not reflect.

    `film`: a Film, or a list of them, outermost first, on both faces of metal flakes or of platelets, by default those
    of mica, 1.58. Light is coherent within the films of one face; from one face of a platelet to the other it is not,
    as the thickness of platelets differs more than a wavelength. The color turns with the angle, as in interference
    pigments. Films are of one index, or of a Spectrum, and give the stack its `wavelengths`.

    `tau`: optical thickness of the flakes along the normal, [0, 1000]: exp(-tau) of a beam along the normal meets none;
    of pearl flakes and platelets only the light that they do not pass is lost to a beam. Along a ray of cosine mu, the
    optical thickness is tau sqrt(mu^2 + alpha^2 (1 - mu^2)) / mu; platelets take their share of it. `alpha`: the spread
    of the normals, [.1, 1], one number: the area that the flakes show to a ray along the layer, relative to that along
    the normal; 1 is isotropic. `binder`: optical thickness of the absorbing medium between the flakes along the normal,
    [0, 1000]. Its index is that of the Interface above.
    `varying` marks the one layer whose thickness becomes an input of the baked material: `tau` and `binder` are then
    the largest ones.

    Source: Heitz, Dupuy, Crassin and Dachsbacher 2015, "The SGGX microflake distribution", with specular flakes."""

    tau: Channels
    alpha: float
    reflectance: Channels | None = None
    facing: Channels | None = None
    grazing: Channels | None = None
    binder: Channels = 0.0
    name: str = ""
    varying: bool = False
    eta: Channels | None = None
    k: Channels | None = None
    metal: str | None = None
    pearl: bool = False
    ior: Channels | None = None
    film: Film | Sequence[Film] = ()

    kind = "flakes"
    forms = (BY_COLOUR, BY_METAL, BY_SPECTRUM, BY_INDEX, BY_FILM)
    form_prop = "flake_form"
    fields = (AMOUNT, SPREAD, TINT)
    options = (VARYING, PEARL, COATS)
    rare = ()
    has_phase = False
    item = Item(kind, "Flakes", "Small mirrors that lie nearly flat: metallic and pearl paint", 3, icon="PARTICLES")

    def __post_init__(self):
        super().__post_init__()
        if self.film is None or isinstance(self.film, Film):
            object.__setattr__(self, "film", () if self.film is None else (self.film,))
        if self.film and all(getattr(self, form.fields[0].name) is None for form in self.forms):
            object.__setattr__(self, "ior", MICA)

    @property
    def is_metal(self) -> bool:
        """True for flakes of a metal, in any form."""
        return self.reflectance is None and self.ior is None

    def optics(self, index: int) -> tuple[float, float]:
        """(albedo, tau) of one channel along the normal, of flakes and binder; of metal flakes and of platelets as if
        they reflected all."""
        reflected = 1.0 if self.reflectance is None or self.pearl else channel(self.reflectance, index)
        tau = channel(self.tau, index) * self.taken(index) + channel(self.binder, index)
        return reflected * self.share(index), tau

    def taken(self, index: int) -> float:
        """The share of the light that meets a flake and does not pass it, in one channel."""
        return channel(self.reflectance, index) if self.pearl and self.reflectance is not None else 1.0

    def share(self, index: int) -> float:
        """The share of the flakes in the extinction along the normal, in one channel."""
        tau, binder = channel(self.tau, index) * self.taken(index), channel(self.binder, index)
        return 1.0 if binder == 0.0 else tau / (tau + binder)
