# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks as JSON: round trips, canonical form and hash, and errors of bad files."""

import copy
import json
import math

import pytest

import lamina
from lamina import Black, Conductor, HalfSpace, HenyeyGreenstein, Isotropic, Knot, Lambert, Medium, Rayleigh, Stack

STACKS = {
    "sheet": Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.75))]),
    "rgb on Lambert": Stack([Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=HenyeyGreenstein([0.6, 0.7, 0.8]))],
                            base=Lambert([0.5, 0.3, 0.1])),
    "coefficients": Stack([Medium(sigma_s=[1.0, 2.0, 3.0], sigma_a=0.1, thickness=0.5, name="flesh")], base=Black()),
    "varying": Stack([Medium(albedo=0.5, tau=3.0, varying=True, name="dust"), Medium(albedo=1, tau=math.inf)]),
    "half-space": Stack([Medium(albedo=0.5, tau=0.0, phase=Rayleigh())], base=HalfSpace(0.9, HenyeyGreenstein(-0.3))),
    "coloured": Stack([Medium(color=[0.8, 0.4, 0.1], tau=3.0), Medium(color=0.2, over=[0.1, 0.2, 0.3], tau=1.0)],
                      base=Conductor(facing=[0.9, 0.7, 0.4], grazing=0.92)),
    "named": Stack([Medium(albedo=0.5, tau=1.0)], name="Fog", category="Weather", source="chosen by eye"),
    "profile": Stack([Medium(tau=[2.0, 1.0, 3.0], name="silt", varying=True,
                             profile=[Knot(0.0, 0.9, HenyeyGreenstein(0.6)), Knot(0.4, [0.8, 0.7, 0.6]), Knot(0.4, 0.2),
                                      Knot(1.0, 0.5)])]),
    "profile in mm": Stack([Medium(thickness=2.0, phase=Rayleigh(),
                                   profile=[Knot(0, sigma_s=1.0, sigma_a=[0.1, 0.2]),
                                            Knot(1, sigma_s=0.0, sigma_a=0.0)])], Black()),
    "coloured profile": Stack([Medium(tau=2.0, over=0.1,
                                      profile=[Knot(0, color=0.4), Knot(1, color=[0.3, 0.2, 0.5])])]),
    "endless channel": Stack([Medium(albedo=0.5, tau=[1.0, math.inf, 0.0])]),
}


@pytest.mark.parametrize("stack", STACKS.values(), ids=STACKS)
class TestRoundTrip:
    def test_object(self, stack):
        text = json.dumps(stack.to_json(), allow_nan=False)
        again = Stack.from_json(json.loads(text))
        assert again == stack and again.hash == stack.hash and again.to_json() == stack.to_json()

    def test_file(self, stack, tmp_path):
        path = tmp_path / "stack.json"
        stack.save(path)
        assert Stack.load(path) == stack
        assert [p.name for p in tmp_path.iterdir()] == ["stack.json"]

    def test_canonical_form_is_a_stack_of_the_same_hash(self, stack):
        again = Stack.from_json(json.loads(stack.canonical()))
        assert again.canonical() == stack.canonical() and again.hash == stack.hash


def test_hash_is_stable():
    """A pinned hash: earlier bakes are found by it. Change it only together with the schema."""
    assert STACKS["sheet"].canonical() == (
        '{"base": null, "layers": [{"albedo": [0.9], "kind": "medium", "phase": {"g": [0.75], "kind": "hg"}, '
        '"tau": [2.0], "varying": false}], "schema": 1}')
    assert STACKS["sheet"].hash == "9c730c9dce3f3e300b51f0fa37d493ee4cdb0cb4e69b3cfedd2eb3309156c539"
    assert STACKS["rgb on Lambert"].hash == "3b71ea954588c952b93d1a58043d38cb17c1281401f45e6090be67b632170e92"


@pytest.mark.parametrize("one, other", [
    (Stack([Medium(albedo=0.9, tau=2, name="dust")]), Stack([Medium(albedo=0.9, tau=2.0)])),
    (Stack([Medium(sigma_s=3, sigma_a=1, thickness=0.5)]), Stack([Medium(albedo=0.75, tau=2)])),
    (Stack([Medium(albedo=[0.9] * 3, tau=2)]), Stack([Medium(albedo=[0.9] * 3, tau=[2] * 3)])),
    (Stack([Medium(albedo=0.5, tau=1), Black()]), Stack([Medium(albedo=0.5, tau=1)], base=Black())),
    (Stack([Medium(albedo=-0.0, tau=1)]), Stack([Medium(albedo=0.0, tau=1)])),
    (Stack([Medium(albedo=0.5, tau="inf")]), Stack([Medium(albedo=0.5, tau=math.inf)])),
    (Stack([Medium(albedo=0.5, tau=1)], name="fog", category="sky", source="me"), Stack([Medium(albedo=0.5, tau=1)])),
    (Stack([Medium(color=0.5, tau=1)]), Stack([Medium(albedo=lamina.colours.albedo_of(0.5)[0], tau=1)])),
], ids=["names", "coefficients", "channels", "base", "minus zero", "infinity", "texts", "colour"])
def test_equivalent_stacks_have_one_canonical_form(one, other):
    assert one.canonical() == other.canonical() and one.hash == other.hash


def test_different_stacks_have_different_hashes():
    several = [*STACKS.values(), Stack([Medium(albedo=0.9, tau=2.0, phase=Isotropic())]),
               Stack([Medium(albedo=0.9, tau=2.0000001, phase=HenyeyGreenstein(0.75))]),
               Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.75), varying=True)]),
               Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.75))], base=Black())]
    assert len({stack.hash for stack in several}) == len(several)


GOOD = {"schema": 1, "layers": [
    {"kind": "medium", "name": "dust", "albedo": 0.5, "tau": 1.0, "phase": {"kind": "hg", "g": 0.5}},
    {"kind": "medium", "albedo": [0.1, 0.2, 0.3], "tau": "inf", "phase": {"kind": "isotropic"}},
], "base": {"kind": "lambert", "reflectance": 0.5}}


def changed(path, value):
    """GOOD with the item at `path` replaced, or removed when `value` is ... ."""
    data = copy.deepcopy(GOOD)
    place = data
    for key in path[:-1]:
        place = place[key]
    if value is ...:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return data


LAYER = ("layers", 0)
PHASE = (*LAYER, "phase")
FORMS = ("must have either albedo, tau or sigma_s, sigma_a, thickness or color, tau or pigment, amount, sigma_s, "
         "thickness")
MUST_BE_NUMBER = "must be a number or one number per channel"
BAD = [
    (("schema",), 2, "schema = 2: must be at most 1; this stack needs a newer Lamina"),
    (("schema",), 0, "schema = 0: must be 1"),
    (("schema",), "1", "schema = '1': must be 1"),
    (("schema",), True, "schema = True: must be 1"),
    (("schema",), ..., "stack.schema is missing: must be given"),
    (("layers",), ..., "stack.layers is missing: must be given"),
    (("layers",), {}, "layers = {}: must be a list, top layer first"),
    (("author",), "me",
     "stack.author: unknown key; known are base, category, illuminant, layers, name, schema, source, wavelengths"),
    (LAYER, 5, "layers[0] = 5: must be a JSON object"),
    ((*LAYER, "kind"), "snow",
     "layers[0].kind = 'snow': must be 'medium', 'interface', 'film', 'flakes', 'fibers', or a base "
     "at the bottom"),
    ((*LAYER, "kind"), ..., "layers[0].kind is missing: must be given"),
    ((*LAYER, "kind"), [],
     "layers[0].kind = []: must be 'medium', 'interface', 'film', 'flakes', 'fibers', or a base "
     "at the bottom"),
    ((*LAYER, "kind"), {},
     "layers[0].kind = {}: must be 'medium', 'interface', 'film', 'flakes', 'fibers', or a base "
     "at the bottom"),
    (LAYER, {"kind": "black"}, "layers[0].kind = 'black': a base can only stand at the bottom"),
    (("layers", 1), {"kind": "black"}, "layers[1].kind = 'black': a base can only stand at the bottom"),
    ((*LAYER, "thikness"), 1.0, "layers[0].thikness: unknown key; known are albedo, amount, color, kind, name, over, "
                                "phase, pigment, profile, sigma_a, sigma_s, tau, thickness, varying"),
    ((*LAYER, "albedo"), 1.2, "layers[0].albedo = 1.2: must lie in [0, 1]"),
    ((*LAYER, "albedo"), -1, "layers[0].albedo = -1: must lie in [0, 1]"),
    ((*LAYER, "albedo"), math.nan, "layers[0].albedo = nan: must lie in [0, 1]"),
    ((*LAYER, "albedo"), math.inf, "layers[0].albedo = inf: must lie in [0, 1]"),
    ((*LAYER, "albedo"), "half", f"layers[0].albedo = 'half': {MUST_BE_NUMBER}"),
    ((*LAYER, "albedo"), {"r": 1}, f"layers[0].albedo = {{'r': 1}}: {MUST_BE_NUMBER}"),
    ((*LAYER, "albedo"), True, f"layers[0].albedo = True: {MUST_BE_NUMBER}"),
    ((*LAYER, "albedo"), [0.5, 0.5], "layers[1].albedo has 3 channels: must have 2 like layers[0].albedo"),
    ((*LAYER, "tau"), -0.5, "layers[0].tau = -0.5: must lie in [0, infinity]"),
    ((*LAYER, "tau"), [1, None, 1], "layers[0].tau[1] = None: must be a number"),
    ((*LAYER, "tau"), ..., f"layers[0].tau is missing: {FORMS}"),
    ((*LAYER, "sigma_s"), 1, f"layers[0] has two forms: {FORMS}"),
    ((*LAYER, "color"), 0.5, f"layers[0] has two forms: {FORMS}"),
    ((*LAYER, "over"), 0.5, f"layers[0] has two forms: {FORMS}"),
    (("name",), 7, "name = 7: must be a text"),
    (("category",), None, "category = None: must be a text"),
    (("source",), ["me"], "source = ['me']: must be a text"),
    ((*LAYER, "name"), 7, "layers[0].name = 7: must be a text"),
    ((*LAYER, "varying"), "yes", "layers[0].varying = 'yes': must be true or false"),
    (PHASE, "hg", "layers[0].phase = 'hg': must be a JSON object"),
    ((*PHASE, "kind"), "mie", "layers[0].phase.kind = 'mie': must be one of isotropic, hg, rayleigh, "
     "double-hg, draine, cornette-shanks, tabulated, mixture"),
    ((*PHASE, "kind"), [], "layers[0].phase.kind = []: must be one of isotropic, hg, rayleigh, "
     "double-hg, draine, cornette-shanks, tabulated, mixture"),
    ((*PHASE, "g"), 1.2, "layers[0].phase.g = 1.2: must lie in [-0.964, 0.964]"),
    ((*PHASE, "g"), ..., "layers[0].phase.g is missing: must be given"),
    ((*PHASE, "f"), 0.1, "layers[0].phase.f: unknown key; known are g, kind"),
    (("base",), "black", "base = 'black': must be a JSON object"),
    (("base", "kind"), "mirror",
     "base.kind = 'mirror': must be one of lambert, black, half-space, conductor, principled, shader, measured, "
     "retroreflector"),
    (("base", "reflectance"), 2, "base.reflectance = 2: must lie in [0, 1]"),
    (("base", "reflectance"), ..., "base.reflectance is missing: must be given"),
    (("base",), {"kind": "principled", "metallic": 2.0}, "base.metallic = 2: must lie in [0, 1]"),
    (("base",), {"kind": "principled", "roughness": [0.1, 0.2, 0.3]},
     "base.roughness = [0.1, 0.2, 0.3]: must be one number for all channels"),
    (("base",), {"kind": "principled", "inputs": ["ior"]},
     "base.inputs = ['ior']: must be a list of names among color, metallic, roughness"),
    (("base", "phase"), {"kind": "isotropic"}, "base.phase: unknown key; known are kind, reflectance, textured"),
]


def label(case):
    path, value, _ = case
    return f"{'.'.join(map(str, path))}={'missing' if value is ... else value}"


@pytest.mark.parametrize("case", BAD, ids=map(label, BAD))
def test_bad_json(case, tmp_path):
    path, value, sentence = case
    data = changed(path, value)
    with pytest.raises(lamina.StackError) as caught:
        Stack.from_json(data)
    assert str(caught.value) == sentence
    file = tmp_path / "bad.json"
    file.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(lamina.StackError) as caught:
        Stack.load(file)
    assert str(caught.value) == f"{file}: {sentence}"


def test_good_json_is_good():
    assert Stack.from_json(GOOD).channels == 3


def test_two_varying_layers():
    data = copy.deepcopy(GOOD)
    for layer in data["layers"]:
        layer.update(tau=1.0, varying=True)
    with pytest.raises(lamina.StackError, match=r"^layers\[1\].varying = true: only one medium may vary$"):
        Stack.from_json(data)


def test_an_empty_stack():
    with pytest.raises(lamina.StackError, match=r"^layers = \[\]: a stack must hold at least one layer or a base$"):
        Stack.from_json({"schema": 1, "layers": []})


@pytest.mark.parametrize("data", [None, [], "stack", 7])
def test_not_an_object(data):
    with pytest.raises(lamina.StackError, match=r"^stack = .*: must be a JSON object$"):
        Stack.from_json(data)


def test_a_number_too_large_for_a_float():
    with pytest.raises(lamina.StackError, match=r"^layers\[0\].albedo"):
        Stack.from_json(changed((*LAYER, "albedo"), 10**400))


@pytest.mark.parametrize("content", [b"", b"{", b"\x00\xff", b'{"schema": 1, "layers": [', b"[" * 100_000,
                                     b'{"schema": ' + b"1" * 5000 + b"}"],
                         ids=["empty", "truncated", "binary", "cut", "deeply nested", "endless number"])
def test_files_that_are_not_json(content, tmp_path):
    file = tmp_path / "bad.json"
    file.write_bytes(content)
    with pytest.raises(lamina.StackError) as caught:
        Stack.load(file)
    assert str(caught.value).startswith(f"{file}: ") and "\n" not in str(caught.value)


def test_a_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        Stack.load(tmp_path / "none.json")
