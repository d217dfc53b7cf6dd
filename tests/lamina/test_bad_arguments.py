# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad arguments and parts give one sentence each, in which long values are shortened."""

import copy
import json
import math

import numpy as np
import pytest

import lamina
from lamina import ArgumentError, Lambert, Medium, Query, ShardError, Stack, StackError
from lamina.cli import main
from lamina.common.errors import quoted
from lamina.walks.shards import load_part, merge, run_shard, save_part

SLAB = Stack([Medium(albedo=0.9, tau=1.0)], Lambert(0.5))
ODD = [None, math.nan, -1, 0, 2.5, 10**400, -(10**30), "x", "x" * 100000, b"x", [], [1], {}, {"a": 1}, True, object(),
       1j, np.array([]), np.full(3, math.nan), lambda: 0]  # fmt: skip


@pytest.fixture(scope="module")
def solved():
    return lamina.solve(SLAB, "preview")


@pytest.fixture(scope="module")
def sheet():
    """A solved sheet and its table."""
    stack = Stack([Medium(albedo=0.9, tau=1.0)])
    return lamina.solve(stack, "preview"), lamina.bake(stack, "preview")


def sentence_of(error):
    text = str(error.value)
    assert "\n" not in text and len(text) < 400
    return text


@pytest.mark.parametrize("name", ["quality", "threads", "nodes"])
@pytest.mark.parametrize("value", ODD, ids=lambda value: type(value).__name__)
def test_any_argument_of_a_solve_is_checked(name, value):
    if (name == "nodes" and value is None) or (name == "threads" and type(value) is int and value == 0):
        return  # these two are good
    with pytest.raises(ArgumentError) as caught:
        lamina.solve(SLAB, **{"quality": "preview", name: value})
    assert sentence_of(caught).startswith(f"{name} = ")


@pytest.mark.parametrize("nodes", [0, -5, 2.5, 7, 161, 10000, True, "16"])
def test_nodes_that_cannot_be(nodes):
    for run in (lamina.solve, lamina.bake):
        with pytest.raises(ArgumentError, match=r"^nodes = .*: must be a whole number from 8 to 160$"):
            run(SLAB, "preview", nodes=nodes)


@pytest.mark.parametrize("value", [None, {}, {"schema": 1, "layers": []}, [Medium(albedo=0.5, tau=1.0)], "slab"],
                         ids=lambda value: type(value).__name__)
def test_what_is_no_stack_is_refused_by_all_that_take_one(value):
    for call in (lamina.solve, lamina.bake, lambda stack: lamina.estimate(stack, 0.5, 0.5),
                 lambda stack: run_shard(stack, Query(0.5, 0.5), "transfer", 4096, 0, (1, 1))):
        with pytest.raises(ArgumentError, match=r"^stack = .*: must be a lamina.Stack, the id of a preset"):
            call(value)


@pytest.mark.parametrize(("name", "value"), [
    ("row_stride", 0), ("row_stride", 1.5), ("row_stride", 34),
    ("basis", []), ("closures", 5), ("closures", [5]), ("closures", "diffuse"), ("closures", ["ggx:nan"]),
    ("progress", 5), ("cancel", "x"), ("quality", []), ("quality", None)])
def test_any_argument_of_a_bake_is_checked(name, value):
    with pytest.raises(ArgumentError, match=f"^{name}"):
        lamina.bake(SLAB, **{"quality": "preview", name: value})


@pytest.mark.parametrize("seed", ["x", -1, 1 << 64, 0.5])
def test_seeds_that_cannot_be(seed):
    for call in (lambda: lamina.estimate(SLAB, 0.5, 0.5, samples=4096, seed=seed),
                 lambda: run_shard(SLAB, Query(0.5, 0.5), "transfer", 4096, seed, (1, 1))):
        with pytest.raises(ArgumentError, match=r"^seed = .*: must be a whole number from 0 to 2\^64 - 1$"):
            call()


def test_a_bake_has_no_seed():
    with pytest.raises(TypeError, match="seed"):
        lamina.bake(SLAB, "preview", seed=1)


@pytest.mark.parametrize(("layer", "taus", "words"), [
    (0, -1.0, "taus = -1: must lie in"), (0, [math.nan], "taus\\[0\\] = nan"),
    (0, None, "taus = None"), (1, 1.0, "layer = 1: must be a whole number from 0 to 0"), (-1, 1.0, "layer = -1"),
    (0.0, 1.0, "layer = 0.0"), (0, "x", "taus = 'x'"), (0, 10**400, "taus")])
def test_thicknesses_that_cannot_be(solved, layer, taus, words):
    with pytest.raises((ArgumentError, StackError), match=f"^{words}"):
        solved.with_thickness(layer, taus)


def test_as_many_thicknesses_as_channels():
    three = lamina.solve(Stack([Medium(albedo=[0.9, 0.8, 0.7], tau=1.0)]), "preview")
    with pytest.raises(ArgumentError, match="^taus has 2 channels: must have 3 like the stack"):
        three.with_thickness(0, [1.0, 2.0])


def test_only_media_have_a_thickness():
    coated = lamina.solve(Stack([lamina.Interface(1.5), Medium(albedo=0.9, tau=1.0)], Lambert(0.5)), "preview")
    with pytest.raises(ArgumentError, match="layer = 0: must be a medium, flakes or fibers, this one is"):
        coated.with_thickness(0, 1.0)
    thicker = lamina.solve(Stack([lamina.Interface(1.5), Medium(albedo=0.9, tau=2.0)], Lambert(0.5)), "preview")
    assert coated.with_thickness(1, 2.0).reflectance(0.5) == pytest.approx(thicker.reflectance(0.5), rel=1e-3)


@pytest.mark.parametrize("value", [-0.1, 1.1, math.nan, math.inf, None, "x", [0.5], True])
def test_reflectances_that_cannot_be(solved, value):
    with pytest.raises(ArgumentError, match=r"^reflectance = .*: must lie in \[0, 1\]$"):
        solved.with_base_reflectance(value)


@pytest.mark.parametrize(("arguments", "words"), [
    (("x", 0.5, 0.0), "mu_o = 'x': must be a number or an array"),
    (([0.5, 0.6], [0.1, 0.2, 0.3], 0.0), "mu_o \\(2,\\), mu_i \\(3,\\), dphi \\(\\): shapes must"),
    ((0.5, {}, 0.0), "mu_i = {}"), ((0.5, 0.5, 1j), "dphi = 1j"), ((0.5, 0.5, 10**400), "dphi = 1000")])
def test_directions_that_are_no_numbers(solved, arguments, words):
    with pytest.raises(ArgumentError, match=f"^{words}"):
        solved.brdf(*arguments)


def test_sides_and_paths_of_any_type(solved):
    for value in ([], None, 5, {}):
        with pytest.raises(ArgumentError, match="^side = "):
            solved.reflectance(0.5, value)
        with pytest.raises(ArgumentError, match="^path = "):
            solved.grid(value, 0.5, 0.5, 0.0)


@pytest.mark.parametrize("parts", [None, 1, "scattered", np.array([True, False]), []])
def test_parts_are_wanted_or_not(sheet, parts):
    for function in sheet:
        for call in (function.reflectance, function.transmittance):
            with pytest.raises(ArgumentError, match="^parts = .*: must be True or False$"):
                call(0.5, parts=parts)
            assert np.array_equal(sum(call(0.5, parts=np.True_)), call(0.5))


GRAZING = {
    "slab": Stack([Medium(albedo=0.9, tau=2.0, phase=lamina.HenyeyGreenstein(0.75))]),
    "rough": Stack([lamina.Interface(1.5, 0.1), Medium(albedo=0.9, tau=1.0)], Lambert(0.5)),
    "smooth": Stack([lamina.Interface(1.5), Medium(albedo=0.9, tau=1.0)], Lambert(0.5)),
    "metal": Stack([], lamina.Conductor(0.2, 3.0, 0.3)),
    "beckmann": Stack([lamina.Interface(1.5, 0.3, "beckmann")], Lambert(0.5)),
}


@pytest.mark.parametrize("name", GRAZING)
def test_the_smallest_cosine_gets_the_limit_at_grazing(name):
    """Along the way to it values settle: 1e-6 is off by about a millionth."""
    solved = lamina.solve(GRAZING[name], "preview")

    def looks(mu):
        return [*solved.brdf([mu, 0.5], [0.5, mu], 1.0), solved.reflectance(mu), solved.transmittance(mu)]

    for least in (5e-324, 1e-308, 1e-155, 1e-30):
        assert np.array(looks(least)) == pytest.approx(np.array(looks(1e-6)), rel=1e-4, abs=1e-6)
        assert np.isfinite(solved.brdf(least, least, 1.0)).all()
        assert np.isfinite(solved.grid("reflect", least, [least], 0.0)).all()
    assert Query(5e-324, 0.5).mu_o == 1e-9


SHEET = Stack([Medium(albedo=0.5, tau=1.0)])
TRIANGLE = lamina.dust.Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))


@pytest.mark.parametrize(("call", "says"), [
    (lambda: lamina.solve(SHEET, "preview").to_xarray("a"), "mu_o = 'a': must be a number or an array of numbers"),
    (lambda: lamina.bake(SHEET, "preview", closures=[]), "closures = []: must hold a lobe id, or be None"),
    (lambda: lamina.dust.settle_image(TRIANGLE, np.zeros((1, 3, 2)), (8,)),
     "size = [8]: must be one or two whole numbers from 1 to"),
    (lambda: lamina.dust.settle_image(TRIANGLE, "a", 8), "uvs_per_corner = 'a': must be an array of numbers"),
], ids=["to_xarray", "closures", "size", "uvs"])
def test_wrong_arguments_get_a_sentence(call, says):
    with pytest.raises(ValueError) as caught:
        call()
    assert str(caught.value).startswith(says) and "\n" not in str(caught.value)


@pytest.fixture(scope="module")
def parts():
    return [run_shard(SLAB, Query(0.5, 0.5), "transfer", 200000, 0, (number, 2)) for number in (1, 2)]


DAMAGE = {
    "channels": (lambda part: part["channels"].append(part["channels"][0]), "has 2 channels: must have 1 like"),
    "no channels": (lambda part: part["channels"].clear(), "channels = \\[\\]: must be a list of at least one channel"),
    "sum": (lambda part: part["channels"][0][0].__setitem__(0, math.nan), "= \\[nan, .*must be five finite numbers"),
    "squares": (lambda part: part["channels"][0][0].__setitem__(1, -1.0), "a sum of squares must not be negative"),
    "no count": (lambda part: part["channels"][0][0].__setitem__(3, 0), "\\[3\\] = 0: must be 65536"),
    "negative count": (lambda part: part["channels"][0][0].__setitem__(3, -65536), "\\[3\\] = -65536: must be 65536"),
    "events": (lambda part: part["channels"][0][0].__setitem__(4, -1), "\\[4\\] = -1: must be a whole number"),
    "table error": (lambda part: part.update(table_error=math.inf), "table_error = inf: must be a number from 0"),
    "shard": (lambda part: part.update(shard=[3, 2]), "shard = 3/2: must be i/n"),
    "blocks": (lambda part: part["job"].update(blocks=10**30), "job.blocks = 1000.*: must be a whole number"),
    "job": (lambda part: part["job"].pop("seed"), "not a complete part of an estimate"),
}


@pytest.mark.parametrize(("damage", "words"), DAMAGE.values(), ids=DAMAGE)
def test_damaged_parts_are_refused(parts, tmp_path, damage, words):
    part = copy.deepcopy(parts[1])
    damage(part)
    path = tmp_path / "part.json"
    path.write_text(json.dumps(part))
    for call in (lambda: merge([parts[0], part]), lambda: merge([parts[0], load_part(path)])):
        with pytest.raises(ShardError, match=words) as caught:
            call()
        sentence_of(caught)


@pytest.mark.parametrize("value", ODD, ids=lambda value: type(value).__name__)
def test_what_is_no_part_at_all(value):
    for call in (lambda: merge(value), lambda: merge([value])):
        with pytest.raises(ShardError) as caught:
            call()
        sentence_of(caught)


def test_a_key_that_is_given_twice_is_refused(tmp_path, capsys):
    path = tmp_path / "stack.json"
    text = json.dumps(SLAB.to_json())
    path.write_text(text.replace('"tau": 1.0', '"tau": 1.0, "tau": 2.0'))
    with pytest.raises(StackError, match="stack.json: not a JSON file \\(key 'tau' is given twice in one object\\)"):
        Stack.load(path)
    assert main(["bake", str(path), "-o", str(tmp_path / "out.npz")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("value", ["x" * 10**6, "x\n" * 10**5, list(range(10**6)), {"a" * 10**6: 1}, 10**4000, 10**5000,
                                   [[["x" * 999] * 99] * 99]], ids=lambda value: type(value).__name__)
def test_long_values_are_cut_short(value):
    assert len(quoted(value)) <= 150 and "\n" not in quoted(value)
    for call in (lambda: Medium(albedo=value, tau=1.0), lambda: Medium(albedo=0.5, tau=1.0, phase=value),
                 lambda: Medium(albedo=0.5, tau=1.0, varying=value)):
        with pytest.raises(StackError) as caught:
            Stack([call()])
        sentence_of(caught)
    with pytest.raises(StackError) as caught:
        Stack.from_json({"schema": 1, "layers": [{"kind": "medium", "albedo": 0.5, "tau": 1.0, str(value)[:10**6]: 1}]}
                        if not isinstance(value, int) else {"schema": value, "layers": []})
    sentence_of(caught)


def test_names_of_any_type_and_length():
    for call in (lamina.presets.load, lamina.metals.conductor):
        for value in (None, [], "x" * 10**6, 5):
            with pytest.raises(lamina.UnknownName) as caught:
                call(value)
            sentence_of(caught)


@pytest.mark.parametrize("call", [
    lambda: lamina.colours.shown(5), lambda: lamina.metals.colours_of(5), lambda: lamina.export.tabulate(5),
    lambda: lamina.rgl.save_bsdf(5, "x.bsdf"), lambda: lamina.estimate(SLAB, 0.5, 0.5, method=[])])
def test_what_is_of_another_kind(call):
    with pytest.raises(ArgumentError) as caught:
        call()
    sentence_of(caught)


@pytest.mark.parametrize("arguments", [
    ["--mu-i", "nan"], ["--mu-i", "2"], ["--mu-i", "0.5", "--samples", "0"], ["--mu-i", "0.5", "--seed", "-1"],
    ["--mu-i", "0.5", "--target-error", "nan"], ["--mu-i", "0.5", "--dphi", "inf"],
    ["--mu-i", "0.5", "--shard", "3/2", "-o", "part.json"]])
def test_arguments_of_the_command_line_are_bad_input(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    SLAB.save("slab.json")
    assert main(["estimate", "slab.json", *arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("lamina: ") and error.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["slab.json"]


def test_long_words_of_a_command_line_are_cut_short(capsys):
    assert main(["bake", "x" * 10000, "-o", "x.npz"]) == 2
    assert len(capsys.readouterr().err) < 400
    assert main(["bake", "x" * 10000 + ".json", "-o", "x.npz"]) == 1
    error = capsys.readouterr().err
    assert len(error) < 400 and "File name too long" in error
    with pytest.raises(SystemExit) as caught:
        main(["bake", "slab.json", "-o", "x.npz", "--quality", "x" * 10000])
    assert caught.value.code == 2 and len(capsys.readouterr().err) < 400


LOADS = {"stack": Stack.load, "table": lamina.Lut.load, "spectrum": lamina.Spectrum.load, "part": load_part,
         "interior": lamina.Interior.load, "walks": lamina.WalkPart.load, "marble": lamina.Marble.load,
         "function": lamina.export.load_npz, "measurements": lamina.measurements.load,
         "base": lamina.measurements.load_base, "mesh": lamina.ply.load}


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("path", [None, 3, [], {"a": 1}, math.nan])
def test_what_is_no_path_is_refused_by_all_that_load(name, path):
    with pytest.raises(ValueError, match="^path = .*: must be a string or a Path$"):
        LOADS[name](path)


@pytest.mark.parametrize("part", [None, 3, {}, np.zeros(3), [{}], {"schema": 1}])
def test_what_is_no_part_is_not_saved(part, tmp_path):
    with pytest.raises(ShardError, match="^part: not a part of an estimate$"):
        save_part(part, tmp_path / "part.json")
    assert not list(tmp_path.iterdir())
