# SPDX-License-Identifier: GPL-3.0-or-later
"""The layer stack: edited in the panel, read by the batch, solved by the solver; its hash names a bake."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..common import json_file
from ..common.arguments import check_path
from ..common.atomic import write_atomically
from ..common.errors import StackError, quoted
from ..common.observer import rec709
from ..kinds.bases import Base, Conductor, Measured
from ..kinds.boundaries import Interface, is_oriented
from ..kinds.fields import all_fields, channel, channel_count, check_keys
from ..kinds.films import Film
from ..kinds.flakes import Flakes
from ..kinds.layers import OrientedLayer
from ..kinds.limits import STACK_SCHEMA as SCHEMA
from ..kinds.spectra import D65, Spectrum, read_spectrum
from .by_wavelength import RGB, check_illuminant, parts_by_wavelength
from .colours import albedos_of_layer, check_colours
from .coverage import NOTHING, first_film, without_film
from .layers import Medium
from .metals import indices_of
from .picture import stack_picture
from .profile import optical_knots
from .requirements import Requirements
from .stack_checks import Layer, check_base, check_films, check_layer
from .stack_entries import read_parts
from .stack_plain import canonical_base, canonical_layer, given, plain

# Measured at preview quality: 64 media, .2 CPU-s to solve and 55 MB; each rough boundary adds about half a second.
MOST_LAYERS = 64
THICK = Medium | OrientedLayer  # layers with an optical thickness


@dataclass(frozen=True)
class Stack(Requirements):
    """Layers, top first, on a base. `base=None` is a thin sheet: light leaves at the bottom. `name`, `category` and
    `source` (of the numbers) are texts for the user and not part of the hash.

    `wavelengths`, in nm, says that each channel is light of one wavelength; None: red, green and blue, or any channels,
    but lamina.WAVELENGTHS if a quantity is a Spectrum, a medium has a pigment, or a metal its name. Spectra become one
    value per wavelength, and three values, red, green and blue, become the smoothest spectrum of this colour. Tables of
    stacks with wavelengths are red, green and blue: linear Rec. 709 under `illuminant`, one of "D65", "A" (light
    bulbs), "E" (equal energy) and "LED" (a white LED, LED-B3), or a Spectrum; a white surface is white under each. Thin
    films in a stack without wavelengths need one or three channels and make it three, see Film. Where the base's color
    is an input of the node group, each of its red, green and blue counts as that of a gray base in its channel.

    A stack has at most 64 layers. Raises StackError if a value is out of range, channels disagree, or the stack is
    empty."""

    layers: Sequence[Layer]
    base: Base | None = None
    name: str = ""
    category: str = ""
    source: str = ""
    wavelengths: Sequence[float] | None = None
    illuminant: str | Spectrum = D65
    _indices: tuple = field(init=False, repr=False, compare=False)
    _given: dict = field(init=False, repr=False, compare=False)  # see SpectralParts
    _implied: bool = field(init=False, repr=False, compare=False)

    texts = ("name", "category", "source")

    def __init__(self, layers: Sequence[Layer] = (), base: Base | None = None, name: str = "",
                 category: str = "", source: str = "", wavelengths: Sequence[float] | None = None,
                 illuminant: str | Spectrum = D65):
        if not isinstance(layers, Sequence) or isinstance(layers, str):
            raise StackError(f"layers = {quoted(layers)}: must be a list, top layer first")
        layers = list(layers)
        if layers and base is None and isinstance(layers[-1], Base):
            base = layers.pop()
        if len(layers) > MOST_LAYERS:
            raise StackError(f"layers has {len(layers)} entries: a stack must have at most {MOST_LAYERS}")
        known = parts_by_wavelength(layers, base, wavelengths)
        layers, base = known.layers, known.base
        object.__setattr__(self, "wavelengths", known.wavelengths)
        object.__setattr__(self, "illuminant", check_illuminant(illuminant, known.wavelengths))
        object.__setattr__(self, "_given", known.given)
        object.__setattr__(self, "_implied", known.implied)
        checked = tuple(check_layer(layer, f"layers[{i}]") for i, layer in enumerate(layers))
        object.__setattr__(self, "layers", checked)
        object.__setattr__(self, "base", check_base(base))
        if not checked and base is None:
            raise StackError("layers = []: a stack must hold at least one layer or a base")
        for text, value in zip(self.texts, (name, category, source), strict=True):
            if not isinstance(value, str):
                raise StackError(f"{text} = {quoted(value)}: must be a text")
            object.__setattr__(self, text, value)
        self._check_channels()
        check_films(checked, self.base, self.channels)
        for kinds in (THICK, Interface):
            varying = self._varying(kinds)
            if len(varying) > 1:
                word = "interface" if kinds is Interface else "medium"
                raise StackError(f"layers[{varying[1]}].varying = true: only one {word} may vary")
        varies = self.varying
        if varies is not None and max(self._thick(varies).optics(c)[1] for c in range(self.channels)) == math.inf:
            raise StackError(f"layers[{varies}].tau = inf: a varying layer needs a largest thickness")
        for number, layer in enumerate(checked):
            if isinstance(layer, Medium):
                check_colours(layer, self.channels, f"layers[{number}]")
        if isinstance(self.base, Conductor):
            object.__setattr__(self, "_indices", indices_of(self.base, self.channels, "base"))
        for number, layer in enumerate(checked):
            if isinstance(layer, Flakes) and layer.is_metal:
                self.flake_indices(number)

    def _repr_html_(self) -> str:
        return stack_picture(self)

    @property
    def channels(self) -> int:
        """Number of channels: 1 when every quantity is a single number, but 3 with films in white light."""
        if self.wavelengths is not None:
            return len(self.wavelengths)
        count = channel_count(self._quantities())
        return RGB if count == 1 and self.has_films else count

    @property
    def table_channels(self) -> int:
        """Number of channels of a lookup table: 3, red, green and blue, for wavelengths."""
        return self.channels if self.wavelengths is None else RGB

    def channel_name(self, index: int) -> str:
        """"channel 2", or its wavelength, such as "550 nm", for messages."""
        return f"channel {index}" if self.wavelengths is None else f"{self.wavelengths[index]:g} nm"

    @property
    def has_films(self) -> bool:
        """True if a layer is a thin film."""
        return any(isinstance(layer, Film) for layer in self.layers)

    def films(self, position: int) -> tuple[Film, ...]:
        """The films, top first, that lie on the interface at `position`, or on the base at len(layers)."""
        found = self.layers[first_film(self.layers, position):position]
        return tuple(layer for layer in found if isinstance(layer, Film))

    def seen(self, values: np.ndarray, axis: int = -1) -> np.ndarray:
        """Values by channel along `axis` as they are seen: of wavelengths linear Rec. 709 under the illuminant."""
        if self.wavelengths is None:
            return values
        return rec709(values, tuple(self.wavelengths), axis, self.illuminant)

    def _check_channels(self) -> None:
        if isinstance(self.base, Measured) and self.wavelengths is not None:
            raise StackError("base.kind = 'measured': has red, green and blue, and cannot lie in a stack with "
                             "wavelengths, pigments or spectra")
        count = channel_count(self._quantities())
        if self.wavelengths is not None and count not in (1, len(self.wavelengths)):
            raise StackError(f"wavelengths has {len(self.wavelengths)} entries: must have {count} like the channels")
        if self.wavelengths is None and self.has_films and count not in (1, RGB):
            raise StackError(f"layers: have {count} channels and thin films: must have 1 or {RGB} channels, or "
                             "wavelengths")

    @property
    def varying(self) -> int | None:
        """Index of the medium, or the layer of flakes or fibers, whose thickness is an input, if any."""
        return next(iter(self._varying(THICK)), None)

    @property
    def covering(self) -> int | None:
        """Index of the interface whose coverage is an input, if any."""
        return next(iter(self._varying(Interface)), None)

    @property
    def uncovered(self) -> Stack | None:
        """The stack where the varying interface is absent, with the media that belong to it, see Interface; None if no
        interface varies."""
        if self.covering is None:
            return None
        layers = without_film(self.layers, self.covering, self.channels)
        return self.over(self.given_base, layers if layers or self.base is not None else [NOTHING])

    @property
    def given_base(self) -> Base | None:
        """The base as it was given: with red, green and blue where `base` has the smoothest spectrum of this color."""
        return self._given.get(len(self.layers), self.base)

    def over(self, base: Base | None, layers: Sequence[Layer] | None = None) -> Stack:
        """A new stack of the same layers, or of these, on another base, in the same light."""
        return Stack(self.layers if layers is None else layers, base, wavelengths=self.wavelengths,
                     illuminant=self.illuminant)

    def _varying(self, kinds) -> list[int]:
        return [i for i, layer in enumerate(self.layers)
                if isinstance(layer, kinds) and getattr(layer, "varying", False)]

    @property
    def label(self) -> str:
        """The stack in a few words: its name, or what it is made of."""
        return self.name or f"{len(self.layers)} layers on {self.base.kind if self.base else 'nothing'}"

    @property
    def hash(self) -> str:
        """Identifies the stack's content: SHA-256 of the canonical form, hexadecimal."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()

    def turned(self) -> Stack:
        """The layers upside down, on the same base."""
        layers = [layer.turned() if isinstance(layer, Medium) else layer for layer in reversed(self.layers)]
        albedos = [tuple(reversed(found)) if isinstance(layer, Medium) and layer.profile is not None else found
                   for layer, found in zip(self.layers, self._albedos, strict=True)]
        return self._derived(layers, self.base, reversed(albedos))

    def with_facets(self, layers: Sequence[Layer], base: Base | None) -> Stack:
        """The same stack with other facets: `layers` and `base` may differ from the stack's only in the width of
        facets."""
        return self._derived(layers, base, self._albedos)

    def with_sizes(self, layers: Sequence[Layer]) -> Stack:
        """The same stack with other thicknesses: `layers` may differ from the stack's only in the thickness of media
        without a profile, and in an albedo in place of a colour with this albedo."""
        return self._derived(layers, self.base, self._albedos)

    def _derived(self, layers, base, albedos) -> Stack:
        """A stack of checked parts with known albedos."""
        derived = object.__new__(Stack)
        changes = {"layers": tuple(layers), "base": base, "_albedos": tuple(albedos), "_given": {}, "_implied": False}
        for name, value in {**self.__dict__, **changes}.items():
            object.__setattr__(derived, name, value)
        return derived

    def optics(self, layer: int, channel_index: int) -> tuple[float, float]:
        """(albedo, tau) of a layer in one channel. For a layer given by a colour, the albedo for this colour; for a
        profile, the mean albedo over the optical depth; for flakes and fibers see their `optics`."""
        medium = self._thick(layer)
        albedo, tau = medium.optics(channel_index)
        if isinstance(medium, Medium) and medium.profile is not None:
            knots = self.knots(layer, channel_index)
            parts = [0.5 * (a + b) * (below - above) for (above, a, _), (below, b, _) in itertools.pairwise(knots)]
            return (math.fsum(parts) / tau if tau > 0.0 else 0.0), tau
        return self._albedos[layer][channel_index] if albedo is None else albedo, tau

    def knots(self, layer: int, channel_index: int) -> list[tuple[float, float, tuple]]:
        """The knots of a layer with a profile in one channel: (optical depth, albedo, phase function as the core takes
        it), top first. Between knots, albedo times phase function is linear."""
        return optical_knots(self._medium(layer), self._albedos[layer], channel_index)

    def indices(self, channel_index: int) -> tuple[float, float]:
        """(eta, k) of a conductor base in one channel; computed from its two colours if these are given."""
        eta, k = self._indices
        return channel(eta, channel_index), channel(k, channel_index)

    def flake_indices(self, layer: int) -> tuple:
        """(eta, k), numbers or one per channel, of the metal of a layer of flakes."""
        flakes = self.layers[layer]
        assert isinstance(flakes, Flakes)
        return indices_of(flakes, self.channels, f"layers[{layer}]")

    def _thick(self, index: int) -> Medium | OrientedLayer:
        layer = self.layers[index]
        assert isinstance(layer, THICK)
        return layer

    def _medium(self, index: int) -> Medium:
        layer = self.layers[index]
        assert isinstance(layer, Medium)
        return layer

    @property
    def is_oriented(self) -> bool:
        """True if a surface of the stack has anisotropic facets."""
        return any(map(is_oriented, (*self.layers, self.base)))

    @property
    def tangent(self) -> tuple[float, bool]:
        """(angle of the first anisotropic surface in [0, pi), true if all others lie along or across it)."""
        surfaces = (*self.layers, self.base)
        angles = [s.angle for s in surfaces if isinstance(s, Interface | Conductor) and is_oriented(s)]
        return angles[0] % math.pi, all(abs(math.sin(2.0 * (angle - angles[0]))) < 1e-12 for angle in angles)

    def canonical(self) -> str:
        """A text that is equal for all stacks with optically equal layers: albedo and tau of each channel, without
        names, keys sorted."""
        layers = [canonical_layer(self, index, self._albedos[index]) for index in range(len(self.layers))]
        spectral = {} if self.wavelengths is None else {"wavelengths": self.wavelengths}
        data = {"schema": SCHEMA, **spectral, **self._light(), "layers": layers, "base": canonical_base(self)}
        return json.dumps(data, sort_keys=True)

    def to_json(self) -> dict:
        """A JSON object; from_json reads it."""
        layers = []
        for number, layer in enumerate(self.layers):
            entry: dict = {"kind": layer.kind}
            if layer.name:
                entry["name"] = layer.name
            if not isinstance(layer, Medium):
                layers.append({**entry, **plain(self._given.get(number, layer))})
                continue
            medium = self._given.get(number, layer)
            entry.update(given(medium))
            entry["phase"] = medium.phase.to_json()
            if layer.profile is not None:
                entry["profile"] = [knot.to_json() for knot in layer.profile]
            if layer.varying:
                entry["varying"] = True
            layers.append(entry)
        base = None if self.base is None else plain(self.given_base)
        if isinstance(self.base, Measured) and self.base.name:
            base = {"name": self.base.name, **(base or {})}
        texts = {text: getattr(self, text) for text in self.texts if getattr(self, text)}
        spectral = {} if self.wavelengths is None or self._implied else {"wavelengths": list(self.wavelengths)}
        return {"schema": SCHEMA, **texts, **spectral, **self._light(), "layers": layers, "base": base}

    def _light(self) -> dict:
        """The illuminant as JSON, if it is not the usual one."""
        light = self.illuminant
        return {} if light == D65 else {"illuminant": light.to_json() if isinstance(light, Spectrum) else light}

    @classmethod
    def from_json(cls, data) -> Stack:
        """Reads a JSON object, written by to_json or by hand. Raises StackError."""
        known = {"schema", "layers", "base", "wavelengths", "illuminant", *cls.texts}
        check_keys(data, known, "stack", required={"schema", "layers"})
        schema = data["schema"]
        if isinstance(schema, bool) or not isinstance(schema, int) or schema < 1:
            raise StackError(f"schema = {quoted(schema)}: must be {SCHEMA}")
        if schema > SCHEMA:
            raise StackError(f"schema = {quoted(schema)}: must be at most {SCHEMA}; this stack needs a newer Lamina")
        if not isinstance(data["layers"], list):
            raise StackError(f"layers = {quoted(data['layers'])}: must be a list, top layer first")
        layers, base = read_parts(data["layers"], data.get("base"))
        texts = {text: data[text] for text in cls.texts if text in data}
        illuminant = read_spectrum(data.get("illuminant", D65), "illuminant")
        return cls(layers, base, **texts, wavelengths=data.get("wavelengths"), illuminant=illuminant)

    @classmethod
    def load(cls, path: str | os.PathLike) -> Stack:
        """Reads a stack's JSON file. Raises StackError, with the file's name, and OSError."""
        path = check_path(path)
        try:
            data = json_file.parse(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise StackError(f"{path}: not a JSON file ({error})") from None
        try:
            return cls.from_json(data)
        except StackError as error:
            raise StackError(f"{path}: {error}") from None

    def save(self, path: str | os.PathLike) -> None:
        """Writes the stack as JSON, completely or not at all."""
        text = json.dumps(self.to_json(), indent=2) + "\n"
        write_atomically(path, lambda file: file.write(text.encode()))

    def _quantities(self):
        """(path, value) of every quantity that may have channels."""
        for index, layer in enumerate(self.layers):
            yield from _fields_of(layer, f"layers[{index}]")
            if isinstance(layer, Medium):
                yield from layer.phase.quantities(f"layers[{index}].phase")
                for number, knot in enumerate(layer.profile or ()):
                    yield from knot.quantities(f"layers[{index}].profile[{number}]")
        if self.base is not None:
            yield from _fields_of(self.base, "base")
            if isinstance(self.base, Measured) and self.base.channels > 1:
                yield "base.table", (0.0,) * self.base.channels
            if self.base.has_phase:
                yield from self.base.phase.quantities("base.phase")

    @cached_property
    def _albedos(self) -> tuple:
        """The albedos of layers that are given by colours, by layer and channel; for a profile, by layer, knot and
        channel. The solver finds them when they are first needed."""
        return tuple(albedos_of_layer(layer, self.channels) if isinstance(layer, Medium) else None
                     for layer in self.layers)


def _fields_of(thing, path):
    for quantity in all_fields(thing):
        value = getattr(thing, quantity.name)
        if not isinstance(value, Spectrum):
            yield f"{path}.{quantity.name}", value
