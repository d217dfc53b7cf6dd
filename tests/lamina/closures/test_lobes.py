# SPDX-License-Identifier: GPL-3.0-or-later
"""The closed forms of the closures, checked without Blender."""
import json
import math
from dataclasses import asdict, replace

import numpy as np
import pytest

import lamina
from lamina import lobes
from lamina.closures.lobe import Geometry

MU = np.array([0.02, 0.05, 0.2, 0.5, 0.8, 0.99])
DPHI = np.linspace(0.0, np.pi, 9)
GRID = (MU[:, None, None], MU[None, :, None], DPHI[None, None, :])


def _ahead(lobe):
    """The lobe without directions behind the viewer's."""

    def evaluate(mu_o, mu_i, dphi):
        ahead = Geometry(mu_o, mu_i, dphi, below=True).cos_between < 0.0
        return ahead * lobe.evaluate(mu_o, mu_i, dphi)

    return replace(lobe, evaluate=evaluate)


HALOS = [lobes.by_id("halo:0.05"), lobes.by_id("halo:0.55")]


@pytest.mark.parametrize("lobe", [*lobes.DICTIONARY, *HALOS], ids=lambda lobe: lobe.id)
class TestEveryLobe:
    def test_is_finite_and_non_negative(self, lobe):
        value = lobe.evaluate(*GRID)
        assert value.shape == (6, 6, 9)
        assert np.all(np.isfinite(value)) and np.all(value >= 0.0) and value.max() > 0.0

    def test_is_symmetric_about_the_plane_of_incidence(self, lobe):
        mu_o, mu_i, dphi = GRID
        mirrored = lobe.evaluate(mu_o, mu_i, 2.0 * np.pi - dphi)
        assert mirrored == pytest.approx(lobe.evaluate(*GRID), rel=1e-9, abs=1e-14)

    def test_reflects_no_more_than_it_gets(self, lobe):
        """Albedo of sampled directions. A lobe about the direction straight through is evaluated behind the viewer
        too."""
        albedo = lobes.directional_albedo(_ahead(lobe) if lobe.strays else lobe, MU)
        if lobe.strays:
            albedo = albedo + lobes.directional_albedo(replace(lobe, evaluate=lobe.strayed), MU)
        assert albedo.shape == MU.shape
        assert np.all(albedo < 1.01)

    def test_recipe_is_plain_data(self, lobe):
        recipe = json.loads(json.dumps(asdict(lobe.node)))
        assert recipe["type"].startswith("ShaderNodeBsdf")
        assert lobe.side in ("reflection", "transmission")

    def test_tilted_normals_only_where_cycles_samples_them_rightly(self, lobe):
        if lobe.node.normal != "N":
            assert lobe.node.type.removeprefix("ShaderNodeBsdf") in ("Diffuse", "Translucent", "Toon")


def test_ids_are_unique_and_found():
    ids = [lobe.id for lobe in lobes.DICTIONARY]
    assert len(set(ids)) == len(ids)
    assert all(lobes.by_id(i).id == i for i in ids)
    with pytest.raises(KeyError, match="no_such"):
        lobes.by_id("no_such")


def test_ggx_of_roughness_one_is_lommel_seeliger():
    mu_o, mu_i, dphi = GRID
    expected = np.broadcast_to(mu_i / (2.0 * np.pi * (mu_i + mu_o)), (6, 6, 9))
    assert lobes.ggx(1.0).evaluate(*GRID) == pytest.approx(expected, rel=1e-9)


def test_ggx_is_reciprocal():
    mu_o, mu_i, dphi = GRID
    for lobe in (lobes.ggx(0.6), lobes.fresnel_ggx(1.4)):
        swapped = lobe.evaluate(mu_i, mu_o, dphi) / mu_o
        assert lobe.evaluate(*GRID) / mu_i == pytest.approx(swapped, rel=1e-9)


def test_a_halo_is_round_about_the_mirror_direction():
    """Half the peak at equal angles in the plane of incidence and across it; an isotropic GGX is narrower across."""
    mu, angle = 0.3, 0.1
    sine = np.sqrt(1.0 - mu**2)
    mirror, ahead, across = np.array([-sine, 0.0, mu]), np.array([mu, 0.0, sine]), np.array([0.0, 1.0, 0.0])

    def at(lobe, aside):
        x, y, z = np.cos(angle) * mirror + np.sin(angle) * aside
        return float(lobe.evaluate(mu, z, np.arctan2(-y, -x)))

    def shape(lobe):
        """Mean of both sides in the plane, relative to the value across."""
        return 0.5 * (at(lobe, ahead) + at(lobe, -ahead)) / at(lobe, across)

    assert shape(lobes.by_id("halo:0.05")) == pytest.approx(1.0, abs=0.15)
    assert shape(lobes.ggx(0.05**0.5)) > 3.0


def test_fresnel_lobe_is_black_backwards_and_full_forwards():
    lobe = lobes.fresnel_ggx(1.5)
    assert lobe.evaluate(0.5, 0.5, np.pi) == pytest.approx(0.0, abs=1e-12)
    grazing = 1e-4
    bare = lobes.ggx(1.0).evaluate(grazing, grazing, 0.0)
    assert lobe.evaluate(grazing, grazing, 0.0) == pytest.approx(bare, rel=2e-3)


def test_lambert_lobes_integrate_to_what_their_tilt_leaves():
    for tilt in (0.0, 40.0, -70.0):
        albedo = lobes.directional_albedo(lobes.diffuse(("tilt", tilt)), 0.5)
        assert albedo == pytest.approx(0.5 * (1.0 + np.cos(np.radians(tilt))), rel=1e-3)


def test_toon_is_flat_inside_and_black_outside():
    lobe = lobes.toon(0.25, 0.25)
    cosine = np.cos(np.radians([0.0, 20.0, 33.75, 46.0, 80.0]))
    full = 1.0 / (2.0 * np.pi * (1.0 - np.cos(np.radians(45.0))))
    assert lobe.evaluate(0.7, cosine, 1.0) == pytest.approx(full * np.array([1, 1, 0.5, 0, 0]), abs=1e-12)


@pytest.mark.parametrize("closure", [None, 3, [], ["diffuse"], "x", "mirror:2"])
def test_closures_that_are_not_in_the_dictionary(closure):
    for call in (lobes.by_id, lobes.recipe):
        with pytest.raises(ValueError, match=r"^closure = .*: not in the dictionary$"):
            call(closure)


@pytest.mark.parametrize("normal", [None, 3, [], "x", 1.5])
def test_normals_that_cannot_be(normal):
    for call in (lobes.diffuse, lobes.translucent):
        with pytest.raises(ValueError, match="^normal = .*: must be one of N, I, N"):
            call(normal)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [None, "x", [0.5, 0.6], math.nan, math.inf, -1.5, 1e308, True])
def test_shapes_that_cannot_be(value):
    for name, call in (("roughness", lobes.ggx), ("roughness", lobes.beckmann), ("roughness", lobes.mirror),
                       ("anisotropy", lambda one: lobes.ggx(0.5, one)), ("ior", lobes.fresnel_ggx),
                       ("roughness", lambda one: lobes.fresnel_ggx(1.5, one)),
                       ("size", lambda one: lobes.toon(one, 0.1)), ("smooth", lambda one: lobes.toon(0.1, one)),
                       ("size", lambda one: lobes.toon_glossy(one, 0.1)),
                       ("smooth", lambda one: lobes.toon_glossy(0.1, one)), ("sigma", lobes.sheen_ashikhmin),
                       ("along", lambda one: lobes.through(one, 0.1)), ("across", lambda one: lobes.through(0.1, one)),
                       ("lean", lambda one: lobes.through(0.1, 0.1, one))):
        with pytest.raises(lamina.ArgumentError, match=f"^{name} = .*: must lie in "):
            call(value)


@pytest.mark.parametrize("normal", [("tilt", "x"), ("tilt", math.nan), ("lean", None), ("tilt",), ("x", 1.0)])
def test_turned_normals_that_cannot_be(normal):
    for call in (lobes.diffuse, lobes.translucent, lambda one: lobes.toon(0.1, 0.1, one)):
        with pytest.raises(lamina.ArgumentError, match="^normal"):
            call(normal)


def test_cosines_of_an_albedo_that_cannot_be():
    for mu, words in ((math.nan, "holds a value that is not"), (2.0, "= 2: must lie in"), ("x", "= 'x': must be")):
        with pytest.raises(lamina.ArgumentError, match=f"^mu_o {words}"):
            lobes.directional_albedo(lobes.diffuse(), mu)


def test_only_a_lobe_has_an_albedo():
    with pytest.raises(ValueError, match="^lobe = 'diffuse': must be a lamina.lobes.Lobe$"):
        lobes.directional_albedo("diffuse", 0.5)
