# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's layers <-> the stack JSON of DESIGN's contract 1.

`to_dict` and `assign` need no native module; whatever judges or hashes a stack asks `lamina`.
Blender keeps float32. Numbers are written as the shortest decimal that is the same float32, so that
.9 typed in the panel, .9 in a file and .9 in Python make one and the same hash.
"""

import math
import struct

from . import changes, migration, native
from .messages import RefusedError

JSON_SCHEMA = 1
NEWER = "this version of the add-on does not know it"


class PanelStackError(RefusedError):
    """A valid stack that the panel cannot hold; str() is one sentence."""


def to_dict(material):
    """The stack of `material` as plain JSON data, top layer first."""
    settings = material.lamina
    return {
        "schema": JSON_SCHEMA,
        "layers": [_layer_dict(layer) for layer in settings.layers],
        "base": _base_dict(settings.base),
    }


def to_stack(material):
    """`lamina.Stack` of the material. Raises lamina.StackError, NativeMissingError."""
    return native.require().Stack.from_json(to_dict(material))


def assign(material, data):
    """Replace the layers and base of `material` by the JSON data of a *valid* stack.

    All is read before anything is changed. Raises PanelStackError.
    """
    layers = [_layer_values(layer, f"layers[{index}]") for index, layer in enumerate(data["layers"])]
    base = _base_values(data.get("base"))
    settings = material.lamina
    migration.start(material)
    settings.layers.clear()
    for values in layers:
        _write(settings.layers.add(), values)
    _write(settings.base, base)
    settings.active_index = 0
    changes.tell(material)


def assign_stack(material, stack):
    """Like `assign`, from a `lamina.Stack`."""
    assign(material, stack.to_json())


def import_file(material, path):
    """Read a stack JSON into `material`.

    Raises lamina.StackError, OSError, PanelStackError, NativeMissingError; the material is as it was then.
    """
    assign_stack(material, native.require().Stack.load(path))


def export_file(material, path):
    """Write the stack of `material` as JSON. Raises lamina.StackError, OSError, NativeMissingError."""
    to_stack(material).save(path)


# Properties -> JSON


def _layer_dict(layer):
    result = {"kind": layer.kind, "name": layer.name}
    if layer.mode == "coefficients":
        result["sigma_s"] = _channels(layer.sigma_s)
        result["sigma_a"] = _channels(layer.sigma_a)
        result["thickness"] = "inf" if layer.infinite else shortest(layer.thickness)
    else:
        result["albedo"] = _channels(layer.albedo)
        if layer.infinite:
            result["tau"] = "inf"
        else:
            result["tau"] = _channels(layer.tau_rgb) if layer.tau_per_channel else shortest(layer.tau)
    result["phase"] = _phase_dict(layer)
    result["varying"] = layer.varying
    return result


def _base_dict(base):
    if base.kind == "none":
        return None
    if base.kind == "lambert":
        return {"kind": "lambert", "reflectance": _channels(base.reflectance)}
    if base.kind == "half-space":
        return {"kind": "half-space", "albedo": _channels(base.albedo), "phase": _phase_dict(base)}
    return {"kind": base.kind}


def _phase_dict(owner):
    if owner.phase == "hg":
        return {"kind": "hg", "g": shortest(owner.g)}
    return {"kind": owner.phase}


def _channels(values):
    """One number when the channels agree (a grey stack bakes in a third of the time), else three."""
    numbers = [shortest(value) for value in values]
    return numbers[0] if numbers[0] == numbers[1] == numbers[2] else numbers


def shortest(value):
    """The decimal with the fewest digits that is the same float32 as `value`."""
    single = struct.pack("f", value)
    for digits in range(1, 10):
        text = f"{value:.{digits}g}"
        if struct.pack("f", float(text)) == single:
            return float(text)
    return value


# JSON -> property values


def _layer_values(layer, where):
    if layer.get("kind", "medium") != "medium":
        raise PanelStackError(f"{where}.kind = {layer['kind']}: {NEWER}")
    values = {"kind": "medium", "name": layer.get("name") or "Layer"}
    values["varying"] = bool(layer.get("varying", False))
    if "sigma_s" in layer:
        thickness, infinite = _finite(_single(layer["thickness"], f"{where}.thickness"))
        values |= {"mode": "coefficients", "infinite": infinite}
        values["sigma_s"] = _triple(layer["sigma_s"], f"{where}.sigma_s")
        values["sigma_a"] = _triple(layer.get("sigma_a", 0.0), f"{where}.sigma_a")
        if not infinite:
            values["thickness"] = thickness
    else:
        values |= {"mode": "optical", "albedo": _triple(layer["albedo"], f"{where}.albedo")}
        values |= _tau_values(layer["tau"], f"{where}.tau")
    return values | _phase_values(layer.get("phase"), f"{where}.phase")


def _tau_values(tau, where):
    each = [_finite(value) for value in (tau if isinstance(tau, list | tuple) else [tau])]
    if all(infinite for _, infinite in each):
        return {"infinite": True}
    if any(infinite for _, infinite in each):
        raise PanelStackError(f"{where} = {tau}: in Blender all channels are infinite, or none")
    numbers = _triple([number for number, _ in each], where)
    if len(set(numbers)) == 1:
        return {"infinite": False, "tau_per_channel": False, "tau": numbers[0]}
    return {"infinite": False, "tau_per_channel": True, "tau_rgb": numbers, "tau": max(numbers)}


def _base_values(base):
    if base is None:
        return {"kind": "none"}
    values = {"kind": base["kind"]}
    if base["kind"] not in ("lambert", "black", "half-space"):
        raise PanelStackError(f"base.kind = {base['kind']}: {NEWER}")
    if "reflectance" in base:
        values["reflectance"] = _triple(base["reflectance"], "base.reflectance")
    if "albedo" in base:
        values["albedo"] = _triple(base["albedo"], "base.albedo")
    return values | (_phase_values(base.get("phase"), "base.phase") if base["kind"] == "half-space" else {})


def _phase_values(phase, where):
    phase = phase or {"kind": "isotropic"}
    if phase["kind"] not in ("isotropic", "hg", "rayleigh"):
        raise PanelStackError(f"{where}.kind = {phase['kind']}: {NEWER}")
    values = {"phase": phase["kind"]}
    if phase["kind"] == "hg":
        g = _single(phase["g"], f"{where}.g")
        if abs(g) > 0.99:
            raise PanelStackError(f"{where}.g = {g}: in Blender it must lie in [-0.99, 0.99]")
        values["g"] = g
    return values


def _triple(value, where):
    values = list(value) if isinstance(value, list | tuple) else [value]
    if len(values) not in (1, 3):
        raise PanelStackError(f"{where} has {len(values)} channels: a Blender material takes 1 or 3")
    return values if len(values) == 3 else values * 3


def _single(value, where):
    values = list(value) if isinstance(value, list | tuple) else [value]
    if any(other != values[0] for other in values):
        raise PanelStackError(f"{where} = {value}: in Blender it is one number for all channels")
    return values[0]


def _finite(value):
    """(number or None, is infinite)."""
    infinite = value in ("inf", "Infinity") or (isinstance(value, float) and math.isinf(value))
    return (None if infinite else value), infinite


def _write(group, values):
    for key, value in values.items():
        setattr(group, key, value)
