# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films on boundaries, whose reflections interfere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from .errors import StackError, quoted
from .fields import Channels, Field, check_keys
from .hashable import Hashable
from .panel import Item, Panel
from .spectra import Spectrum, read_spectrum

FILM_IOR = Field("ior", 0.01, 10.0, panel=Panel(
    "Film Index", "Refractive index of the film, real part", 1.8, step=1, precision=3, words="film index",
    prop="film_ior"))
EXTINCTION = Field("k", 0.0, 20.0, panel=Panel(
    "Film Extinction", "Imaginary part of the film's refractive index: 0 is clear", 0.0, step=1, precision=3,
    words="film extinction", prop="film_k"))
FILM_THICKNESS = Field("thickness", 0.0, 5000.0, "nm", single=True, panel=Panel(
    "Film Thickness (nm)", "Thickness of the film in nanometres: the colors of the first order lie below about 300",
    100.0, soft_high=1000.0, step=100, precision=1, words="film thickness", prop="film_thickness"))


MOST_COATS = 16


@dataclass(frozen=True)
class Film(Hashable):
    """A thin film on the next Interface or on the Conductor below, whose reflections interfere: oxide on steel, oil on
    water, an anti-reflex coating. One or more films, top first, lie between the refractive index above them and that of
    the interface, or the metal, that follows them. They share its facets: each facet reflects and passes light as the
    films do. A film between two media needs the Interface that names the next index: a soap film is
    [Film(1.33, 400), Interface(ior=1)]. Between equal indices the interface must be smooth.

    `ior`: absolute refractive index n, or complex n + ik, of n in [0.01, 10] and k in [0, 20]; a number, one per
    channel, or a Spectrum. `k` may be given apart. `thickness`: in nanometres, [0, 5000].

    Light is coherent in the films, incoherent in the rest of the stack, and unpolarised. In a stack of red, green and
    blue the films' factors are means over the spectrum: reflectance and transmittance at 81 wavelengths from 380 to 780
    nm, as linear Rec. 709 under D65 with the CIE 1931 observer, clipped to [0, 1]. This is right for light reflected
    once from a white surrounding. Indices per channel count for the whole spectrum of their channel. For colours after
    several reflections give the stack its `wavelengths`.

    Facets below an absorbing film on an Interface do not return the energy that shadowing loses (`compensate`)."""

    ior: Channels | complex | Spectrum
    thickness: float
    k: Channels | Spectrum = 0.0
    name: str = ""

    kind = "film"
    fields = (FILM_IOR, EXTINCTION, FILM_THICKNESS)
    options = ()
    rare = ()
    has_phase = False
    item = Item(kind, "Thin Film", "A film of nanometres on the interface or metal below it, whose colors come from "
                "interference: oxide, oil, soap, anti-reflex coating", 2, icon="COLOR")

    def __post_init__(self):
        super().__post_init__()
        values = self.ior.values if isinstance(self.ior, Spectrum) else self.ior
        several = values if isinstance(values, tuple) else (values,)
        if not any(isinstance(one, complex) for one in several):
            return
        if self.k != 0.0:
            raise StackError(f"film.k = {quoted(self.k)}: must be left out beside a complex ior")
        for name, part in (("ior", "real"), ("k", "imag")):
            own = tuple(getattr(one, part, one) for one in several)
            own = Spectrum(self.ior.wavelengths, own) if isinstance(self.ior, Spectrum) else own
            object.__setattr__(self, name, own if isinstance(self.ior, Spectrum | tuple) else own[0])

    @property
    def absorbs(self) -> bool:
        """True unless k is 0 everywhere."""
        values = self.k.values if isinstance(self.k, Spectrum) else self.k
        return any(values) if isinstance(values, tuple) else values != 0.0


@dataclass(frozen=True)
class Coats:
    """The description of a member that holds the films on a flake, outermost first, in place of an Option. A film may
    be given as its JSON object."""

    name: str

    usual = ()
    several = False

    def check(self, value, path: str) -> tuple[Film, ...]:
        """The films with floats. Raises StackError, naming `path`."""
        films = [value] if isinstance(value, Film | Mapping) else value
        if not isinstance(films, list | tuple) or len(films) > MOST_COATS:
            given = f" has {len(films)} entries" if isinstance(films, list | tuple) else f" = {quoted(value)}"
            raise StackError(f"{path}{given}: must be a Film or a list of at most {MOST_COATS}, outermost first")
        return tuple(_checked(film, f"{path}[{number}]") for number, film in enumerate(films))

    @staticmethod
    def plain(films: tuple[Film, ...]) -> list[dict]:
        """JSON objects of checked films."""
        return [{name: value.to_json() if isinstance(value, Spectrum) else value for name, value in (
            ("ior", film.ior), ("k", film.k), ("thickness", film.thickness)) if name != "k" or film.absorbs}
            for film in films]


def _checked(film, path: str) -> Film:
    if isinstance(film, Mapping):
        check_keys(film, {"ior", "k", "thickness"}, path, required={"ior", "thickness"})
        film = Film(**{name: read_spectrum(value, f"{path}.{name}") for name, value in film.items()})
    if not isinstance(film, Film):
        raise StackError(f"{path} = {quoted(film)}: must be a Film")
    values: dict = {}
    for field in Film.fields:
        value, where = getattr(film, field.name), f"{path}.{field.name}"
        if isinstance(value, Spectrum) and not field.single:
            values[field.name] = value.checked(field, where)
            continue
        values[field.name] = field.check(value, where)
        if isinstance(values[field.name], tuple):
            raise StackError(f"{where} = {quoted(value)}: must be one number or a Spectrum on a flake")
    return replace(film, **values, name="")
