# SPDX-License-Identifier: GPL-3.0-or-later
"""The layer stack: what the panel edits, batches read, the solver solves, and a bake is named after."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Sequence
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path

from .atomic import write_atomically
from .errors import StackError
from .fields import channel, channel_count, check_keys, read_kind, to_plain
from .layers import BASES, Base, HalfSpace, Interface, Medium
from .phase import check_phase, read_phase

SCHEMA = 1


@dataclass(frozen=True)
class Stack:
    """Layers, top first, on a base. `base=None` is a thin sheet: light leaves at the bottom.

    Raises StackError when a value is out of range, channels disagree, or there is nothing in it."""

    layers: Sequence[Medium | Interface]
    base: Base | None = None

    def __init__(self, layers: Sequence[Medium | Interface] = (), base: Base | None = None):
        if not isinstance(layers, Sequence) or isinstance(layers, str):
            raise StackError(f"layers = {layers!r}: must be a list, top layer first")
        layers = list(layers)
        if layers and base is None and isinstance(layers[-1], tuple(BASES.values())):
            base = layers.pop()
        checked = tuple(_check_layer(layer, f"layers[{i}]") for i, layer in enumerate(layers))
        object.__setattr__(self, "layers", checked)
        object.__setattr__(self, "base", _check_base(base))
        if not checked and base is None:
            raise StackError("layers = []: a stack must hold at least one layer or a base")
        varying = [i for i, layer in enumerate(checked) if layer.varying]
        if len(varying) > 1:
            raise StackError(f"layers[{varying[1]}].varying = true: only one layer may vary")
        if varying and max(self.optics(varying[0], c)[1] for c in range(self.channels)) == math.inf:
            raise StackError(f"layers[{varying[0]}].tau = inf: a varying layer needs a largest thickness")
        channel_count(self._quantities())

    @property
    def channels(self) -> int:
        """Number of channels: 1 when every quantity is a single number."""
        return channel_count(self._quantities())

    @property
    def varying(self) -> int | None:
        """Index of the layer whose thickness is an input, if any."""
        return next((i for i, layer in enumerate(self.layers) if layer.varying), None)

    @property
    def hash(self) -> str:
        """Name of the stack's content: SHA-256 of the canonical form, hexadecimal."""
        return hashlib.sha256(self.canonical().encode()).hexdigest()

    def optics(self, layer: int, channel_index: int) -> tuple[float, float]:
        """(albedo, tau) of a layer in one channel."""
        medium = self.layers[layer]
        if medium.albedo is not None:
            return channel(medium.albedo, channel_index), channel(medium.tau, channel_index)
        sigma_s = channel(medium.sigma_s, channel_index)
        sigma_t = sigma_s + channel(medium.sigma_a, channel_index)
        if sigma_t == 0.0:
            return 0.0, 0.0
        return sigma_s / sigma_t, sigma_t * channel(medium.thickness, channel_index)

    def canonical(self) -> str:
        """The one text for all stacks that are optically the same layer by layer: albedo and tau of each
        channel, names left out, keys sorted."""
        channels = range(self.channels)
        layers = []
        for index, layer in enumerate(self.layers):
            if isinstance(layer, Interface):
                layers.append(_canonical(layer, self.channels))
                continue
            optics = [self.optics(index, c) for c in channels]
            layers.append({
                "kind": layer.kind,
                "albedo": [to_plain(albedo) for albedo, _ in optics],
                "tau": [to_plain(tau) for _, tau in optics],
                "phase": layer.phase.canonical(self.channels),
                "varying": layer.varying,
            })
        base = None if self.base is None else _canonical(self.base, self.channels)
        return json.dumps({"schema": SCHEMA, "layers": layers, "base": base}, sort_keys=True)

    def to_json(self) -> dict:
        """A plain object for json.dump; from_json reads it back."""
        layers = []
        for layer in self.layers:
            entry = {"kind": layer.kind}
            if layer.name:
                entry["name"] = layer.name
            if isinstance(layer, Interface):
                layers.append({**entry, **_plain(layer)})
                continue
            for form in Medium.forms:
                for quantity in form:
                    value = getattr(layer, quantity.name)
                    if value is not None:
                        entry[quantity.name] = to_plain(value)
            entry["phase"] = layer.phase.to_json()
            if layer.varying:
                entry["varying"] = True
            layers.append(entry)
        base = None if self.base is None else _plain(self.base)
        return {"schema": SCHEMA, "layers": layers, "base": base}

    @classmethod
    def from_json(cls, data) -> Stack:
        """Reads what to_json wrote, or what a person did. Raises StackError."""
        check_keys(data, {"schema", "layers", "base"}, "stack", required={"schema", "layers"})
        schema = data["schema"]
        if isinstance(schema, bool) or not isinstance(schema, int) or schema < 1:
            raise StackError(f"schema = {schema!r}: must be {SCHEMA}")
        if schema > SCHEMA:
            raise StackError(f"schema = {schema}: must be at most {SCHEMA}; this stack needs a newer Lamina")
        if not isinstance(data["layers"], list):
            raise StackError(f"layers = {data['layers']!r}: must be a list, top layer first")
        layers = []
        for index, entry in enumerate(data["layers"]):
            path = f"layers[{index}]"
            kind = read_kind(entry, path)
            is_base = isinstance(kind, str) and kind in BASES
            last = index == len(data["layers"]) - 1
            if is_base and last and data.get("base") is None:
                layers.append(_read_base(entry, path))
            elif is_base:
                raise StackError(f"{path}.kind = '{kind}': a base can only stand at the bottom")
            elif kind == Medium.kind:
                layers.append(_read_medium(entry, path))
            elif kind == Interface.kind:
                layers.append(_read(Interface, entry, path, {"name"}))
            else:
                raise StackError(f"{path}.kind = {kind!r}: must be 'medium', 'interface', or a base at the bottom")
        base = data.get("base")
        return cls(layers, None if base is None else _read_base(base, "base"))

    @classmethod
    def load(cls, path: str | os.PathLike) -> Stack:
        """Reads a stack's JSON file. Raises StackError, with the file's name, and OSError."""
        try:
            data = json.loads(Path(path).read_text(encoding="utf-8"))
        except (ValueError, RecursionError) as error:
            raise StackError(f"{path}: not a JSON file ({error})") from None
        try:
            return cls.from_json(data)
        except StackError as error:
            raise StackError(f"{path}: {error}") from None

    def save(self, path: str | os.PathLike) -> None:
        """Writes the stack as JSON; the file appears whole or not at all."""
        text = json.dumps(self.to_json(), indent=2) + "\n"
        write_atomically(path, lambda file: file.write(text.encode()))

    def _quantities(self):
        """(path, value) of everything that may have channels."""
        for index, layer in enumerate(self.layers):
            if isinstance(layer, Interface):
                yield from _fields_of(layer, f"layers[{index}]")
                continue
            for form in Medium.forms:
                for quantity in form:
                    yield f"layers[{index}].{quantity.name}", getattr(layer, quantity.name)
            yield from layer.phase.quantities(f"layers[{index}].phase")
        if self.base is not None:
            yield from _fields_of(self.base, "base")
            if isinstance(self.base, HalfSpace):
                yield from self.base.phase.quantities("base.phase")


def _fields_of(thing, path):
    for quantity in thing.fields:
        yield f"{path}.{quantity.name}", getattr(thing, quantity.name)


def _checked(thing, path):
    values = {q.name: q.check(getattr(thing, q.name), f"{path}.{q.name}") for q in thing.fields}
    for name, allowed in thing.choices.items():
        value = getattr(thing, name)
        if type(value) is not type(allowed[0]) or value not in allowed:
            words = " or ".join(json.dumps(choice) for choice in allowed)
            raise StackError(f"{path}.{name} = {value!r}: must be {words}")
    return replace(thing, **values)


def _check_layer(layer, path: str) -> Medium | Interface:
    if isinstance(layer, tuple(BASES.values())):
        raise StackError(f"{path}.kind = '{layer.kind}': a base can only stand at the bottom")
    if not isinstance(layer, Medium | Interface):
        raise StackError(f"{path} = {layer!r}: must be a layer")
    if not isinstance(layer.name, str):
        raise StackError(f"{path}.name = {layer.name!r}: must be a text")
    if isinstance(layer, Interface):
        return _checked(layer, path)
    given = [form for form in Medium.forms if any(getattr(layer, q.name) is not None for q in form)]
    names = " or ".join(", ".join(q.name for q in form) for form in Medium.forms)
    if len(given) != 1:
        raise StackError(f"{path} has {'two forms' if given else 'no coefficients'}: must have either {names}")
    values = {}
    for quantity in given[0]:
        value = getattr(layer, quantity.name)
        if value is None:
            raise StackError(f"{path}.{quantity.name} is missing: must have either {names}")
        values[quantity.name] = quantity.check(value, f"{path}.{quantity.name}")
    if not isinstance(layer.varying, bool):
        raise StackError(f"{path}.varying = {layer.varying!r}: must be true or false")
    return replace(layer, phase=check_phase(layer.phase, f"{path}.phase"), **values)


def _check_base(base):
    if base is None:
        return None
    if not isinstance(base, tuple(BASES.values())):
        raise StackError(f"base = {base!r}: must be a base or none")
    base = _checked(base, "base")
    if isinstance(base, HalfSpace):
        base = replace(base, phase=check_phase(base.phase, "base.phase"))
    return base


def _plain(thing) -> dict:
    """JSON form of a base or an interface; choices that are the usual ones are left out."""
    entry = {"kind": thing.kind, **{q.name: to_plain(getattr(thing, q.name)) for q in thing.fields}, **_unusual(thing)}
    if isinstance(thing, HalfSpace):
        entry["phase"] = thing.phase.to_json()
    return entry


def _unusual(thing) -> dict:
    """Choices that are not the usual ones: what is new stays out of the hashes of what was before."""
    return {name: getattr(thing, name) for name, allowed in thing.choices.items() if getattr(thing, name) != allowed[0]}


def _canonical(thing, channels: int) -> dict:
    """The same with every quantity repeated for each channel."""
    entry = {"kind": thing.kind, **_unusual(thing)}
    for quantity in thing.fields:
        value = getattr(thing, quantity.name)
        entry[quantity.name] = [to_plain(channel(value, c)) for c in range(channels)]
    if isinstance(thing, HalfSpace):
        entry["phase"] = thing.phase.canonical(channels)
    return entry


def _read_medium(entry, path: str) -> Medium:
    names = {q.name for form in Medium.forms for q in form}
    check_keys(entry, {"kind", "name", "phase", "varying", *names}, path)
    values = {key: value for key, value in entry.items() if key not in ("kind", "phase")}
    if "phase" in entry:
        values["phase"] = read_phase(entry["phase"], f"{path}.phase")
    return Medium(**values)


def _read_base(entry, path: str):
    kind = read_kind(entry, path)
    if not isinstance(kind, str) or kind not in BASES:
        raise StackError(f"{path}.kind = {kind!r}: must be one of {', '.join(BASES)}")
    values = dict(entry)
    phase = values.pop("phase", None) if kind == HalfSpace.kind else None
    base = _read(BASES[kind], values, path)
    return base if phase is None else replace(base, phase=read_phase(phase, f"{path}.phase"))


def _read(cls, entry, path: str, optional: set[str] = frozenset()):
    """An interface or a base from its JSON object; what has a usual value may be left out."""
    names = {quantity.name for quantity in cls.fields}
    usual = {field.name for field in fields(cls) if field.default is not MISSING}
    allowed = {"kind", *names, *cls.choices, *optional}
    check_keys(entry, allowed, path, required=names - usual)
    return cls(**{key: value for key, value in entry.items() if key != "kind"})
