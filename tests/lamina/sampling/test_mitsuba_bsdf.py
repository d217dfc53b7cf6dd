# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin for Mitsuba 3 against the solver: values, albedos, density, and variance beside Mitsuba's `measured`."""

import math
import subprocess
import sys

import mitsuba as mi
import numpy as np
import pytest
from mitsuba_scenes import direction, measured
from z_limit import z_limit

import lamina
import lamina.mitsuba
from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack
from lamina.mitsuba import RenderTable
from lamina.sampling import render_table

OWN = {
    "white": Stack([Medium(1.0, 0.5)], Lambert(1.0)),
    "sheet": Stack([Medium((0.9, 0.6, 0.3), 0.7, HenyeyGreenstein(0.8))]),
    "uneven sheet": Stack([Medium(0.9, 0.5), Medium(0.3, 0.5, HenyeyGreenstein(0.5))]),
    "half-space": Stack([Medium(0.95, math.inf, HenyeyGreenstein(0.3))]),
    "rough coat": Stack([Interface(1.5, 0.1), Medium(0.9, 1.0, HenyeyGreenstein(0.6))], Lambert(0.5)),
    "narrow coat": Stack([Interface(1.5, 0.05), Medium(0.9, 1.0, HenyeyGreenstein(0.6))], Lambert(0.5)),
    "Beckmann coat": Stack([Interface(1.5, 0.1, "beckmann"), Medium(0.9, 1.0)], Lambert(0.5)),
    "smooth coat": Stack([Interface(1.5), Medium(0.9, 1.0, HenyeyGreenstein(0.6))], Lambert((0.5, 0.3, 0.1))),
    "thin dust": Stack([Medium(0.5, 0.2)], Conductor(0.2, 3.9, alpha=0.2)),
}
PRESETS = ("aluminium", "apple-flesh", "celadon", "gold", "heat-tinted-steel-blue", "marble-polished", "milk-glass",
           "paper", "silver", "skin-three-layers", "soap-film")


def made(name, quality="final"):
    solved = lamina.solve(OWN.get(name, name))
    return solved, RenderTable.of(solved, quality)


@pytest.fixture(scope="module")
def tables():
    """Those of our own stacks, coarse: for all that does not depend on the number of knots."""
    known = {}

    def get(name):
        if name not in known:
            known[name] = made(name, "preview")
        return known[name]
    return get


def directions(random, count, below):
    """Cosine-weighted, without the grazing 3 degrees."""
    mu, phi = np.sqrt(random.uniform(0.0025, 1.0, count)), random.uniform(0.0, 2.0 * math.pi, count)
    side = np.sqrt(1.0 - mu * mu)
    return np.column_stack([side * np.cos(phi), side * np.sin(phi), -mu if below else mu])


def exact(solved, sight, view, light):
    """The solver's values."""
    side, path = sight
    dphi = np.arctan2(light[:, 1] * view[:, 0] - light[:, 0] * view[:, 1],
                      -light[:, 0] * view[:, 0] - light[:, 1] * view[:, 1])
    where = side if path == "reflect" else {"top": "bottom", "bottom": "top"}[side]
    call = solved.brdf if path == "reflect" else solved.btdf
    return call(np.abs(view[:, 2]), np.abs(light[:, 2]), dphi, where)


def at(view):
    place = mi.SurfaceInteraction3f()
    place.wi = mi.Vector3f(*view)
    return place


@pytest.mark.parametrize("name", [*OWN, *PRESETS])
def test_values_and_albedos(name):
    """The mean error of values is 1e-4 of the mean value, and albedos are right to .1 %."""
    solved, table = made(name)
    mi.set_variant("scalar_rgb")
    bsdf = lamina.mitsuba.bsdf(table)
    random = np.random.default_rng(1)
    nodes, weights = (0.5 * part for part in np.polynomial.legendre.leggauss(200))
    mu, phi = np.sqrt(nodes + 0.5), (np.arange(180) + 0.5) / 180 * math.pi  # values are even in the azimuth
    around = np.stack([np.sqrt(1.0 - mu * mu)[:, None] * np.cos(phi), np.sqrt(1.0 - mu * mu)[:, None] * np.sin(phi),
                       np.broadcast_to(mu[:, None], (200, 180))], axis=-1).reshape(-1, 3)
    for number, sight in enumerate(table.sights):
        through = sight[1] == "transmit"
        view, light = directions(random, 100, False), directions(random, 100, through)
        wanted = exact(solved, sight, view, light)
        if not wanted.any():
            assert not table.values(number, view, light).any()
            continue
        assert np.abs(table.values(number, view, light) - wanted).sum() < 1e-4 * wanted.sum()
        turned = [1.0, 1.0, -1.0] if sight[0] == "bottom" else [1.0, 1.0, 1.0]
        for one, other, value in zip((view * turned)[:5], (light * turned)[:5], wanted, strict=False):
            got = np.array(bsdf.eval(mi.BSDFContext(), at(one), mi.Vector3f(*other))) / abs(other[2])
            assert got == pytest.approx(np.broadcast_to(value, 3), rel=2e-3, abs=1e-4 * wanted.mean())
        call = solved.transmittance if through else solved.reflectance
        for cosine in (0.9, 0.4):
            oblique = np.array([[math.sqrt(1.0 - cosine**2), 0.0, cosine]])
            values = table.values(number, oblique, around * ([1, 1, -1] if through else 1)).reshape(200, 180, -1)
            albedo = math.pi * np.tensordot(weights, values.mean(axis=1), (0, 0))
            assert albedo == pytest.approx(call(cosine, sight[0], True)[0], rel=1e-3, abs=1e-5)


def drawn(bsdf, view, numbers):
    """(directions (n, 3), weights (n, 3), densities, whether they are specular)."""
    place, context = at(view), mi.BSDFContext()
    found = [bsdf.sample(context, place, one[0], mi.Point2f(one[1:])) for one in numbers.tolist()]
    delta = int(mi.BSDFFlags.Delta)
    return (np.array([list(one.wo) for one, _ in found]), np.array([list(weight) for _, weight in found]),
            np.array([one.pdf for one, _ in found]), np.array([bool(one.sampled_type & delta) for one, _ in found]))


@pytest.mark.parametrize("name", ["white", "sheet", "uneven sheet", "rough coat", "smooth coat"])
def test_the_mean_weight_is_the_albedo(name, tables):
    """By Z-scores, from both sides of a sheet: a white furnace, for the white stack."""
    solved, table = tables(name)
    mi.set_variant("scalar_rgb")
    bsdf = lamina.mitsuba.bsdf(table)
    numbers = np.random.default_rng(2).random((1500, 3))
    for side, sign in (("top", 1.0), ("bottom", -1.0)):
        if solved.stack.base is not None and side == "bottom":
            continue
        view = [0.48, 0.64, 0.6 * sign]
        _, weight, density, specular = drawn(bsdf, view, numbers)
        albedo = solved.reflectance(0.6, side) + (solved.transmittance(0.6, side) if solved.stack.base is None else 0.0)
        z = (weight.mean(axis=0) - albedo) / (weight.std(axis=0) / math.sqrt(len(numbers)) + 3e-4 * albedo)
        assert np.abs(z).max() < z_limit(30)
        direct = solved.reflectance(0.6, side, True)[1].mean() + (
            solved.transmittance(0.6, side, True)[1].mean() if solved.stack.base is None else 0.0)
        assert abs(specular.mean() - direct / albedo.mean()) < z_limit(8) * 0.5 / math.sqrt(len(numbers))


@pytest.mark.parametrize("name", ["sheet", "rough coat"])
def test_the_density_is_that_of_the_directions(name, tables):
    """Chi-squared over cells of the sphere; the density integrates to the share of directions that are valid."""
    _, table = tables(name)
    mi.set_variant("scalar_rgb")
    bsdf, view, count = lamina.mitsuba.bsdf(table), [0.48, 0.64, 0.6], 4000
    light, _, density, specular = drawn(bsdf, view, np.random.default_rng(3).random((count, 3)))
    place, context = at(view), mi.BSDFContext()
    own = ~specular & (density > 0.0)
    for one, stated in zip(light[own][:50], density[own], strict=False):
        assert bsdf.pdf(context, place, mi.Vector3f(*one)) == pytest.approx(stated, rel=1e-3)
    rows, columns, fine = 10, 12, 6
    z = (np.arange(rows * fine) + 0.5) / (0.5 * rows * fine) - 1.0
    turn = ((np.arange(columns * fine) + 0.5) / (0.5 * columns * fine) - 1.0) * math.pi
    stated = np.array([[bsdf.pdf(context, place, direction(a, b)) for b in turn] for a in z])
    expected = count * 4.0 * math.pi * stated.reshape(rows, fine, columns, fine).mean(axis=(1, 3)) / (rows * columns)
    counts = np.histogram2d(light[own][:, 2], np.arctan2(light[own][:, 1], light[own][:, 0]),
                            [np.linspace(-1.0, 1.0, rows + 1), np.linspace(-math.pi, math.pi, columns + 1)])[0]
    seen = expected > 10.0
    squares = ((counts - expected)[seen] ** 2 / expected[seen]).sum()
    assert abs(squares - seen.sum()) < z_limit(2) * math.sqrt(2.0 * seen.sum()), (squares, seen.sum())
    assert expected.sum() == pytest.approx(own.sum(), abs=z_limit(2) * 0.5 * math.sqrt(count))


def sky(light):
    """A dim sky with a lamp of 12 degrees."""
    return 0.3 + 20.0 * (light @ [0.28, -0.6, 0.7493] > 0.98)


@pytest.mark.parametrize("name", ["rough coat", "thin dust", "half-space"])
def test_variance_beside_the_measured_plugin(name, tables, tmp_path):
    """At most 1.3 times that of Mitsuba's plugin, which reads our .bsdf file, under a sky with a lamp."""
    solved, table = tables(name)
    lamina.rgl.save_bsdf(solved, tmp_path / "out.bsdf")
    peer = measured(tmp_path / "out.bsdf")
    numbers, spread = np.random.default_rng(4).random((2500, 3)), {}
    for who, bsdf in (("lamina", lamina.mitsuba.bsdf(table)), ("measured", peer)):
        light, weight, _, _ = drawn(bsdf, [0.0, 0.6, 0.8], numbers)
        radiance = weight[:, 0] * np.where(weight[:, 0] > 0.0, sky(light), 0.0)
        spread[who] = radiance.mean(), radiance.var()
    assert spread["lamina"][1] < 1.3 * spread["measured"][1], spread
    error = math.sqrt((spread["lamina"][1] + spread["measured"][1]) / len(numbers))
    assert abs(spread["lamina"][0] - spread["measured"][0]) < z_limit(3) * error


def test_a_render_by_the_name_of_the_plugin(tables, tmp_path):
    """From a file of a table and from the JSON of a stack: the same picture."""
    solved, table = tables("rough coat")
    table.save(tmp_path / "table.npz")
    mi.set_variant("scalar_rgb")
    lamina.mitsuba.register()

    def picture(bsdf):
        scene = mi.load_dict({
            "type": "scene", "integrator": {"type": "path"}, "light": {"type": "constant"}, "ball": {
                "type": "sphere", "bsdf": bsdf}, "sensor": {
                    "type": "perspective", "to_world": mi.ScalarTransform4f().look_at([0, -4, 0], [0, 0, 0], [0, 0, 1]),
                    "film": {"type": "hdrfilm", "width": 6, "height": 6}, "sampler": {"type": "independent"}}})
        return np.array(mi.render(scene, spp=8, seed=1))

    file = picture({"type": "lamina", "stack": str(tmp_path / "table.npz")})
    assert 0.2 < file[2:4, 2:4].mean() < 1.0
    again = picture(lamina.mitsuba.bsdf(RenderTable.load(tmp_path / "table.npz")))
    np.testing.assert_allclose(file, again, rtol=1e-5)  # threads add up pixels in any order


def test_by_wavelength(tables):
    """Channels at their wavelengths, linear between; grey stacks in every variant; red, green and blue in none."""
    stack = Stack([Medium((0.2, 0.5, 0.9, 0.6), 0.8)], Lambert(0.3), wavelengths=(450.0, 650.0, 550.0, 750.0))
    solved = lamina.solve(stack)
    table = RenderTable.of(solved, "preview")
    mi.set_variant("scalar_spectral")
    place = at([0.0, 0.6, 0.8])
    place.wavelengths = [450.0, 550.0, 650.0, 500.0]
    got = np.array(lamina.mitsuba.bsdf(table).eval(mi.BSDFContext(), place, direction(0.7, 1.0)))
    light = np.array([list(direction(0.7, 1.0))])
    wanted = exact(solved, ("top", "reflect"), np.array([[0.0, 0.6, 0.8]]), light)[0] * 0.7
    assert got == pytest.approx([wanted[0], wanted[2], wanted[1], 0.5 * (wanted[0] + wanted[2])], rel=1e-3)
    grey = lamina.mitsuba.bsdf(tables("rough coat")[1])
    assert np.ptp(np.array(grey.eval(mi.BSDFContext(), place, direction(0.7, 1.0)))) == 0.0
    with pytest.raises(lamina.ArgumentError, match="red, green and blue"):
        lamina.mitsuba.bsdf(tables("smooth coat")[1])


@pytest.mark.parametrize("name", ["dust on gold", "coloured sheet"])
def test_thickness_as_a_texture(name):
    """A number, and a texture: values and the mean weight between the rows of the table."""
    media = {"dust on gold": (Medium(0.8, 1.5, HenyeyGreenstein(0.5), varying=True), Conductor(0.2, 3.9, alpha=0.2)),
             "coloured sheet": (Medium((0.9, 0.6, 0.3), (2.0, 1.0, 1.0), varying=True), None)}
    medium, base = media[name]
    solved = lamina.solve(Stack([medium], base))
    table = RenderTable.of(solved, "preview")
    mi.set_variant("scalar_rgb")
    scale = np.ravel(medium.tau)
    random = np.random.default_rng(5)
    place, context = at([0.48, 0.64, 0.6]), mi.BSDFContext()
    for share in (0.0, 0.11, 0.6, 1.0):
        thin = solved.with_thickness(0, [share * tau for tau in scale])
        for number, sight in enumerate(table.sights[:2]):
            view, light = directions(random, 100, False), directions(random, 100, sight[1] == "transmit")
            wanted = exact(thin, sight, view, light)
            got = table.values(number, view, light, share * scale.max())
            assert np.abs(got - wanted).sum() <= 1e-3 * wanted.sum() + 1e-9, (share, sight)
        bitmap = mi.Bitmap(np.full((2, 2, 1), share * scale.max(), np.float32))
        texture = mi.load_dict({"type": "bitmap", "bitmap": bitmap, "raw": True})
        bsdf = lamina.mitsuba.bsdf(table, texture)
        number = lamina.mitsuba.bsdf(table, float(share * scale.max()))
        by_texture, by_number = (list(one.eval(context, place, direction(0.8, 2.0))) for one in (bsdf, number))
        assert by_texture == pytest.approx(by_number, rel=1e-4)
        _, weight, _, _ = drawn(bsdf, [0.48, 0.64, 0.6], random.random((600, 3)))
        albedo = thin.reflectance(0.6) + (thin.transmittance(0.6) if base is None else 0.0)
        z = (weight.mean(axis=0) - albedo) / (weight.std(axis=0) / math.sqrt(600) + 1e-3 * albedo)
        assert np.abs(z).max() < z_limit(24)
    with pytest.raises(lamina.ArgumentError, match="no varying layer"):
        lamina.mitsuba.bsdf(made("thin dust", "preview")[1], 0.5)


def test_what_is_refused(tmp_path, tables):
    mi.set_variant("scalar_rgb")
    with pytest.raises(lamina.ArgumentError, match=r"must be a lamina\.mitsuba\.RenderTable"):
        lamina.mitsuba.bsdf(tables("rough coat")[0])
    with pytest.raises(lamina.ArgumentError, match=r"solved = Stack.*must be what lamina\.solve returned"):
        RenderTable.of(Stack([], Lambert(0.3)))
    with pytest.raises(lamina.StackError, match="table for renderers"):
        RenderTable.of(lamina.solve(Stack([Interface(1.5, 0.2, alpha_v=0.4)], Lambert(0.3)), "preview"))
    with pytest.raises(lamina.Cancelled, match="table for renderers"):
        RenderTable.of(tables("rough coat")[0], cancel=lambda: True)
    seen = []
    RenderTable.of(tables("sheet")[0], "preview", progress=lambda share, text: seen.append(share))
    assert seen == sorted(seen) and len(seen) > 3 and seen[-1] == 1.0
    path = tmp_path / "table.npz"
    tables("rough coat")[1].save(path)
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(lamina.ExportError, match="not a complete table"):
        RenderTable.load(path)
    mi.set_variant("scalar_spectral_polarized")
    with pytest.raises(lamina.ArgumentError, match="without polarisation"):
        lamina.mitsuba.register()


def test_without_a_variant():
    """A new process, because a variant cannot be taken back."""
    code = "import lamina.mitsuba\ntry:\n    lamina.mitsuba.register()\nexcept ValueError as error:\n    print(error)"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert found == "variant = None: call mitsuba.set_variant with one without polarisation before\n"


@pytest.mark.parametrize("tau", [math.nan, math.inf, -1.0, "x", [1.0], True, {"type": "uniform", "value": 0.5}])
def test_thicknesses_that_cannot_be(tau):
    mi.set_variant("scalar_rgb")
    table = RenderTable.of(lamina.solve(Stack([Medium(0.9, 1.0, varying=True)], Lambert(0.5)), "preview"), "preview")
    with pytest.raises(lamina.ArgumentError, match="^tau = .*: must be a number of at least 0, or a texture of Mit"):
        lamina.mitsuba.bsdf(table, tau)


def test_a_varying_layer_without_thickness():
    """Its table has one row; the thicknesses of rows were divided by 0."""
    table = RenderTable.of(lamina.solve(Stack([Medium(0.9, 0.0, varying=True)], Lambert(0.5)), "preview"), "preview")
    assert table.rows == 1 and table.largest == 0.0


@pytest.mark.parametrize(("name", "value"), [
    ("sights", None), ("sights", [["top"]]), ("sights", []), ("densities", 5), ("densities", [[1]]), ("densities", []),
    ("largest", "x"), ("largest", 2.0), ("wavelengths", 5), ("wavelengths", []), ("wavelengths", ["x"]),
    ("smooth", np.zeros(3)), ("facets", np.zeros(3)), ("mirrored", np.zeros((1, 1, 48, 0))), ("density", np.zeros(3)),
    ("theta_views", np.zeros(3)), ("chance", np.full((1, 1, 32, 2), np.nan)), ("chance", np.zeros((1, 1, 32, 2), int))])
def test_tables_that_do_not_hold_together(tables, tmp_path, name, value):
    header, arrays = render_table.load_archive(saved(tables, tmp_path), *render_table.ARRAYS)
    arrays = dict(zip(render_table.ARRAYS, arrays, strict=True))
    (arrays if name in arrays else header)[name] = value
    render_table.save_archive(tmp_path / "changed.npz", header, **arrays)
    with pytest.raises(lamina.ExportError, match=r"changed\.npz: not a complete table for renderers: its header"):
        RenderTable.load(tmp_path / "changed.npz")


def saved(tables, tmp_path):
    """The file of a table that can be loaded."""
    tables("rough coat")[1].save(tmp_path / "table.npz")
    assert RenderTable.load(tmp_path / "table.npz").rows == 1
    return tmp_path / "table.npz"
