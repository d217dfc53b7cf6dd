# SPDX-License-Identifier: GPL-3.0-or-later
"""Anisotropic facets in stacks: JSON, hashes, values out of range, and who refuses them."""

import pytest
from oriented_stacks import STACKS, medium, metal

import lamina
from lamina import Conductor, Interface, Lambert, Medium, Query, Stack, StackError
from lamina.exchange.export import save_npz
from lamina.exchange.rgl import save_bsdf
from lamina.walks.shards import run_shard

BRUSHED = Stack([Interface(1.5, 0.1, alpha_v=0.3), Medium(sigma_s=1.0, sigma_a=0.1, thickness=1.0)], Lambert(0.5))


@pytest.mark.parametrize("name", STACKS)
def test_json_keeps_the_facets(name):
    again = Stack.from_json(STACKS[name].to_json())
    assert again == STACKS[name]
    assert again.hash == STACKS[name].hash


def test_json_omits_usual_values():
    entry = Stack([Interface(1.5, 0.1)], metal(0.1, None)).to_json()
    assert set(entry["layers"][0]) == {"kind", "ior", "alpha"}
    assert not {"alpha_v", "angle"} & set(entry["base"])
    entry = Stack([Interface(1.5, 0.1, alpha_v=0.3)], metal(0.1, 0.3, 0.2)).to_json()
    assert entry["layers"][0]["alpha_v"] == 0.3 and "angle" not in entry["layers"][0]
    assert entry["base"]["angle"] == 0.2


def test_hashes_tell_widths_and_angles_apart():
    def hash_of(**facets):
        return Stack([Interface(1.5, 0.1, **facets)], Lambert(0.5)).hash

    assert hash_of(alpha_v=0.1, angle=0.4) == hash_of()
    assert len({hash_of(), hash_of(alpha_v=0.3), hash_of(alpha_v=0.2), hash_of(alpha_v=0.3, angle=0.5)}) == 4


@pytest.mark.parametrize("make, sentence", [
    (lambda: Interface(1.5, 0.1, alpha_v=0.0), "layers[0].alpha_v = 0: must lie in (0, 1]"),
    (lambda: Interface(1.5, 0.1, alpha_v=1.2), "layers[0].alpha_v = 1.2: must lie in (0, 1]"),
    (lambda: Interface(1.5, 0.1, alpha_v=float("nan")), "layers[0].alpha_v = nan: must lie in (0, 1]"),
    (lambda: Interface(1.5, 0.1, alpha_v="wide"), "layers[0].alpha_v = 'wide': must be one number for all channels"),
    (lambda: Interface(1.5, 0.1, alpha_v=[0.1, 0.2]), "layers[0].alpha_v = [0.1, 0.2]: must be one number"),
    (lambda: Interface(1.5, 0.1, alpha_v=0.3, angle=7.0), "layers[0].angle = 7: must lie in [-2 pi, 2 pi] rad"),
    (lambda: Interface(1.5, 0.0, alpha_v=0.3), "layers[0].alpha_v = 0.3: needs an alpha above 0"),
    (lambda: Interface(1.5, 0.1, angle=0.3), "layers[0].angle = 0.3: needs an alpha_v"),
])
def test_values_out_of_range(make, sentence):
    with pytest.raises(StackError) as caught:
        Stack([make()], Lambert(0.5))
    assert sentence in str(caught.value).replace('"', "'") and "\n" not in str(caught.value)


def test_a_metal_out_of_range():
    with pytest.raises(StackError, match=r"base.alpha_v = 2: must lie in \(0, 1\]"):
        Stack([], Conductor(eta=0.2, k=3.0, alpha=0.1, alpha_v=2.0))


@pytest.mark.parametrize("call, user", [
    (lambda s, p: lamina.searchlight(s), "a searchlight"),
    (lambda s, p: lamina.estimate_searchlight(s, r=[1.0]), "a searchlight"),
    (lambda s, p: lamina.subsurface_nodes(s), "subsurface scattering"),
    (lambda s, p: lamina.portal_tables(s), "a portal"),
    (lambda s, p: lamina.interior_of_stack(s), "light inside a body"),
    (lambda s, p: lamina.estimate(s, 0.5, 0.5, method="adding"), "method 'adding'"),
    (lambda s, p: run_shard(s, Query(0.5, 0.5), "transfer", 4096, 0, (1, 2)), "an estimate in parts"),
    (lambda s, p: save_npz(s, p / "a.npz"), "an export"),
    (lambda s, p: save_bsdf(s, p / "a.bsdf"), "an export"),
], ids=lambda value: value if isinstance(value, str) else "")
def test_who_refuses_anisotropic_facets(call, user, tmp_path, monkeypatch):
    """In one sentence, before any work."""
    def no_work(*_):
        raise AssertionError("work has begun")

    for name in ("solve", "solve_oriented", "Searchlight", "transfer_walk", "adding_walk"):
        monkeypatch.setattr(lamina._core, name, no_work)
    with pytest.raises(StackError) as caught:
        call(BRUSHED, tmp_path)
    assert str(caught.value) == (f"layers[0].alpha_v = 0.3: must be left out for {user}; only lamina.solve, "
                                 "lamina.estimate and lamina.bake take anisotropic facets")
    assert not list(tmp_path.iterdir())


def test_pictures_and_names_of_such_stacks():
    assert "alpha 0.1 and 0.3" in BRUSHED._repr_html_()
    assert BRUSHED.is_oriented and not Stack([medium(0.5, 1.0, 0.0)], metal(0.1, 0.1)).is_oriented
