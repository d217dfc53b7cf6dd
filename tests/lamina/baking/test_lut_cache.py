# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of finished tables, the estimate of a table's size, and which versions changed which results."""

import os

import numpy as np
import pytest

import lamina
from lamina import (
    Conductor,
    HenyeyGreenstein,
    Interface,
    Lambert,
    Lut,
    Medium,
    PrincipledBase,
    ShaderBase,
    Stack,
)
from lamina.baking.bases.choice import largest_size
from lamina.baking.report import result_changes
from lamina.baking.table import cache as cache_file
from lamina.baking.table.cache import LutCache

DUST = Medium(albedo=[0.9, 0.8, 0.6], tau=0.4)
VARYING = Medium(albedo=0.9, tau=0.4, varying=True)
ON_GREY = Stack([DUST], base=Lambert(0.5))


@pytest.fixture(scope="module")
def lut():
    return lamina.bake(ON_GREY, "preview")


@pytest.fixture
def cache(tmp_path):
    return LutCache(tmp_path / "made" / "here")


def test_a_finished_table_is_found_by_what_it_was_made_of(lut, cache):
    assert cache.load(ON_GREY, "preview", "standard") is None
    cache.save(lut)
    found = cache.load(Stack([DUST], base=Lambert(0.5), name="another name"), "preview", "standard")
    assert found.header == lut.header and np.array_equal(found.weights, lut.weights)
    assert cache.load(ON_GREY, "final", "standard") is None
    assert cache.load(ON_GREY, "preview", "accurate") is None
    assert cache.load(Stack([DUST], base=Lambert(0.4)), "preview", "standard") is None


def test_a_table_of_another_version_or_stack_is_not_taken(lut, cache, monkeypatch):
    cache.save(lut)
    kept = cache.path(ON_GREY.hash, "preview", "standard")
    other = Stack([DUST], base=Lambert(0.4))
    kept.rename(cache.path(other.hash, "preview", "standard"))
    assert cache.load(other, "preview", "standard") is None, "a file of the right name with another stack inside"
    cache.save(lut)
    monkeypatch.setattr(cache_file._core, "__version__", "9.0.0")
    assert cache.load(ON_GREY, "preview", "standard") is None


def test_a_truncated_table_counts_as_missing(lut, cache):
    cache.save(lut)
    kept = cache.path(ON_GREY.hash, "preview", "standard")
    kept.write_bytes(kept.read_bytes()[:-1])
    assert cache.load(ON_GREY, "preview", "standard") is None


def test_pruning_keeps_what_was_used_last(lut, cache):
    cache.save(lut)
    kept = cache.path(ON_GREY.hash, "preview", "standard")
    size = kept.stat().st_size
    for number in range(4):
        copy = cache.path(f"{number}" * 64, "preview", "standard")
        copy.write_bytes(kept.read_bytes())
        os.utime(copy, (100 + number, 100 + number))
    os.utime(kept, (99, 99))
    assert cache.load(ON_GREY, "preview", "standard") is not None, "which counts as a use"
    for name in ("notes.txt", ".x.npz.abc.part"):
        (cache.folder / name).write_text("")
        os.utime(cache.folder / name, (1, 1))
    cache.prune(3 * size)
    cache.remove_forgotten()
    numbers = {path.name[0] for path in cache.folder.glob("*-*-*.npz")} - {kept.name[0]}
    assert kept.exists() and numbers == {"2", "3"} - {kept.name[0]}
    assert sorted(path.name for path in cache.folder.iterdir() if path.suffix != ".npz") == ["notes.txt"]


def test_a_folder_that_cannot_be_written():
    with pytest.raises(OSError):
        LutCache("/sys/lamina").check_writable()


@pytest.mark.parametrize("basis", ["standard", "accurate"])
@pytest.mark.parametrize("stack", [
    ON_GREY,
    Stack([VARYING], base=Lambert(0.5, textured=True)),
    Stack([VARYING], base=ShaderBase(0.5)),
    Stack([VARYING], base=Conductor(eta=0.2, k=3.0, alpha=0.1)),
    Stack([VARYING], base=PrincipledBase(inputs=("color", "metallic"))),
    Stack([DUST]),
    Stack([Interface(ior=1.5), Medium(albedo=0.5, tau=0.1)], base=Lambert(0.5)),
], ids=["fixed", "textured", "shader", "metal", "principled", "sheet", "mirror"])  # fmt: skip
def test_no_table_is_larger_than_estimated(stack, basis):
    height, width, _ = lamina.bake(stack, "preview", basis=basis, row_stride=32).image().shape
    most = largest_size(stack, basis)
    assert height <= most[0] <= 16 * height and width == most[1]


def test_a_table_names_the_version_that_made_it(lut, tmp_path):
    assert lut.header["version"] == lamina.__version__
    path = tmp_path / "lut.npz"
    Lut({**lut.header, "version": 3}, lut.weights).save(path)
    with pytest.raises(lamina.LutError, match="version = 3: must be a text"):
        Lut.load(path)
    earlier = {name: value for name, value in lut.header.items() if name != "version"}
    Lut(earlier, lut.weights).save(path)
    assert "version" not in Lut.load(path).header, "tables of 0.1.0 are read"


ROUGH = Stack([Interface(ior=1.5, alpha=0.2), DUST], base=Lambert(0.5))
TABLE = (
    result_changes.Change("0.2.0", "rough boundaries", lambda stack: stack.hash == ROUGH.hash),
    result_changes.Change("0.10.0", "everything", lambda stack: True),
)


@pytest.mark.parametrize(("running", "baked", "stack", "told"), [
    ("0.1.0", "0.1.0", ROUGH, ""),
    ("0.2.0", "0.1.0", ROUGH, "baked by 0.1.0; 0.2.0 changed rough boundaries"),
    ("0.2.0", "", ROUGH, "baked by 0.1.0 or earlier; 0.2.0 changed rough boundaries"),
    ("0.2.0", "0.1.0", ON_GREY, ""),
    ("0.2.0", "0.2.0", ROUGH, ""),
    ("0.9.3", "0.3.1", ROUGH, ""),
    ("0.10.0", "0.9.3", ON_GREY, "baked by 0.9.3; 0.10.0 changed everything"),
    ("0.10.1", "0.1.0", ROUGH, "baked by 0.1.0; 0.2.0 changed rough boundaries, 0.10.0 changed everything"),
    ("0.2.0", "0.10.0", ROUGH, ""),
    ("0.2.0", "nonsense", ROUGH, "baked by nonsense; 0.2.0 changed rough boundaries"),
])  # fmt: skip
def test_a_newer_version_tells_which_bakes_its_changes_concern(running, baked, stack, told, monkeypatch):
    monkeypatch.setattr(result_changes._core, "__version__", running)
    monkeypatch.setattr(result_changes, "CHANGES", TABLE)
    assert result_changes.told(baked, stack) == told


def test_the_table_of_changes():
    """Rough boundaries have changed since 0.1.0, and so have narrow facets below others, halos of dust,
    and tables over rough bases. Smooth boundaries above media have not."""
    smooth = Stack([Interface(ior=1.5), DUST], base=Lambert(0.5))
    metal = Stack([Interface(ior=1.5)], PrincipledBase(metallic=1.0, roughness=0.1))
    halo = Stack([Medium(albedo=0.8, tau=0.1, phase=HenyeyGreenstein(0.8)), Interface(ior=1.5)], base=Lambert(0.5))
    bow = lamina.Tabulated(cosines=[-1.0, -0.8, 0.0, 1.0], values=[2.0, 1.0, 1.0, 3.0])
    table = Stack([Medium(albedo=0.8, tau=0.1, phase=bow)], base=Conductor(eta=0.2, k=3.0, alpha=0.2))
    stacks = (ROUGH, metal, smooth, ON_GREY, halo, table)
    concerned = [[change.concerns(stack) for stack in stacks] for change in result_changes.CHANGES]
    assert concerned == [[stack is changed for stack in stacks] for changed in (ROUGH, metal, halo, table)]
