# SPDX-License-Identifier: GPL-3.0-or-later
"""Exported scattering functions: the archive agrees with the solver, is refused when damaged, and the command line
writes it completely or not at all."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import lamina
from lamina import ExportError, HenyeyGreenstein, Interface, Lambert, Medium, Stack
from lamina.cli import main
from lamina.export import load_npz, save_npz

SHEET = Stack([Interface(ior=1.5), Medium(albedo=[0.9, 0.6, 0.2], tau=0.7, phase=HenyeyGreenstein(0.4)),
               Medium(albedo=0.5, tau=0.1), Interface(ior=1.0)])
COAT = Stack([Medium(albedo=0.8, tau=1.0)], base=Lambert(0.5))
AXES = {"theta_o": np.radians([0.0, 33.0, 80.0]), "theta_i": np.radians([10.0, 60.0]), "dphi": [0.0, 1.0, 3.0, -1.0]}


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    solved = lamina.solve(SHEET)
    path = tmp_path_factory.mktemp("export") / "sheet.npz"
    save_npz(solved, path, **AXES)
    return solved, path


def test_archive_is_the_scattering_function(sheet):
    solved, path = sheet
    export = load_npz(path)
    assert Stack.from_json(export.header["stack"]) == SHEET and export.header["stack_hash"] == SHEET.hash
    mu_o, mu_i = np.cos(AXES["theta_o"]), np.cos(AXES["theta_i"])
    mesh = np.meshgrid(mu_o, mu_i, AXES["dphi"], indexing="ij")
    for number, side in enumerate(export.header["sides"]):
        for name, evaluate in (("brdf", solved.brdf), ("btdf", solved.btdf)):
            assert export[name].shape == (2, 3, 2, 4, 3)
            # Single precision.
            assert export[name][number] == pytest.approx(evaluate(*mesh, side), rel=1e-6)
        albedo = export["reflectance"] + export["mirror_reflectance"]
        assert albedo[number] == pytest.approx(solved.reflectance(mu_i, side), rel=1e-12)
        through = export["transmittance"] + export["unscattered_transmittance"]
        assert through[number] == pytest.approx(solved.transmittance(mu_i, side), rel=1e-12)
        assert export["diffuse_reflectance"][number] == pytest.approx(solved.reflectance("diffuse", side))
        assert export["diffuse_transmittance"][number] == pytest.approx(solved.transmittance("diffuse", side))


def test_deltas_are_fresnels_and_beers(sheet):
    """Closed forms for a smooth plate: mirrored once at the top and then by all its inner reflections."""
    export = load_npz(sheet[1])
    mu = np.cos(AXES["theta_i"])[:, None]
    inside = np.sqrt(1.0 - (1.0 - mu**2) / 2.25)
    fresnel = 0.5 * (((mu - 1.5 * inside) / (mu + 1.5 * inside)) ** 2
                     + ((1.5 * mu - inside) / (1.5 * mu + inside)) ** 2)
    beam = np.exp(-0.8 / inside)
    rest = 1.0 - fresnel**2 * beam**2
    for side in (0, 1):
        assert export["mirror_reflectance"][side] == pytest.approx(
            np.repeat(fresnel + (1.0 - fresnel) ** 2 * fresnel * beam**2 / rest, 3, axis=1), rel=1e-6)
        assert export["unscattered_transmittance"][side] == pytest.approx(
            np.repeat((1.0 - fresnel) ** 2 * beam / rest, 3, axis=1), rel=1e-6)


def test_brdf_integrates_to_the_albedo(tmp_path):
    """A reader that uses the header alone: axes, units and conventions."""
    save_npz(COAT, tmp_path / "coat.npz", theta_o=np.radians(np.arange(0.0, 90.0, 0.25)))
    export = load_npz(tmp_path / "coat.npz")
    assert "btdf" not in export.arrays and export.header["sides"] == ["top"]
    assert {"theta_o", "theta_i", "dphi", "brdf", "reflectance"} < set(export.header["units"]) == set(export.arrays)
    theta, dphi = export["theta_o"], export["dphi"]
    kernel = export["brdf"][0, ..., 0].astype(float)
    ring = np.sum((kernel[..., 1:] + kernel[..., :-1]) * np.diff(dphi), axis=2)
    integrand = ring * (np.cos(theta) * np.sin(theta))[:, None]
    albedo = np.sum(0.5 * (integrand[1:] + integrand[:-1]) * np.diff(theta)[:, None], axis=0)
    # The trapezium rule's error falls with h^2; near grazing the peak is narrower than these steps.
    assert albedo[:42] == pytest.approx(export["reflectance"][0, :42, 0], rel=1e-4)


def test_equal_exports_are_equal_bytes(sheet, tmp_path):
    save_npz(lamina.solve(SHEET, threads=1), tmp_path / "again.npz", **AXES)
    assert (tmp_path / "again.npz").read_bytes() == sheet[1].read_bytes()


def test_damaged_and_foreign_files_are_refused(sheet, tmp_path):
    whole = sheet[1].read_bytes()
    path = tmp_path / "bad.npz"
    for content in (b"", whole[:100], whole[:-200], b"GIF89a" + whole, whole[:2000] + b"x" * 500 + whole[2500:]):
        path.write_bytes(content)
        with pytest.raises(ExportError, match="not a complete scattering function exported by Lamina"):
            load_npz(path)
    lut = lamina.bake(COAT, "preview")
    lut.save(path)
    with pytest.raises(ExportError, match="not a complete scattering function"):
        load_npz(path)
    np.savez(path, header=np.array([{}], dtype=object), allow_pickle=True)
    with pytest.raises(ExportError, match="not a complete scattering function"):
        load_npz(path)
    with pytest.raises(OSError, match="No such file"):
        load_npz(tmp_path / "absent.npz")


@pytest.mark.parametrize("change, sentence", [
    (lambda header, arrays: header.update(schema=2), "schema 2 needs a newer Lamina"),
    (lambda header, arrays: header.pop("units"), "the header is incomplete"),
    (lambda header, arrays: arrays.update(dphi=arrays["dphi"][:2]), "brdf has the shape"),
    (lambda header, arrays: arrays.update(brdf=arrays["brdf"] * math.nan), "brdf holds values that are not finite"),
    (lambda header, arrays: arrays.update(btdf=-arrays["btdf"]), "btdf holds negative values"),
])
def test_inconsistent_archives_are_refused(sheet, tmp_path, change, sentence):
    export = load_npz(sheet[1])
    header, arrays = dict(export.header), dict(export.arrays)
    change(header, arrays)
    path = tmp_path / "bad.npz"
    np.savez(path, header=np.frombuffer(json.dumps(header).encode(), np.uint8), **arrays)
    with pytest.raises(ExportError, match=sentence):
        load_npz(path)


@pytest.mark.parametrize("axes, sentence", [
    ({"theta_o": [0.0, 1.6]}, r"theta_o = 1.6: must lie in \[0, pi/2\)"),
    ({"theta_i": [-0.1]}, r"theta_i = -0.1: must lie in \[0, pi/2\)"),
    ({"theta_i": []}, "theta_i: must be a list of finite angles"),
    ({"dphi": [math.nan]}, "dphi: must be a list of finite angles"),
])
def test_bad_axes(sheet, tmp_path, axes, sentence):
    with pytest.raises(ValueError, match=sentence):
        save_npz(sheet[0], tmp_path / "out.npz", **axes)
    assert not list(tmp_path.iterdir())


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    SHEET.save("sheet.json")
    Stack([Medium(albedo=[0.1, 0.2], tau=1.0)]).save("two.json")
    return tmp_path


def test_command_line(folder, capfd):
    assert main(["export", "sheet.json", "-o", "sheet.npz", "--threads", "1"]) == 0
    assert "exported in" in capfd.readouterr().out
    assert load_npz("sheet.npz").header["stack_hash"] == SHEET.hash
    assert main(["export", "sheet.json", "-o", "sheet.bsdf"]) == 0
    said = capfd.readouterr().out
    assert "no place for mirror reflection" in said and "transmission" in said
    assert Path("sheet.bsdf").read_bytes().startswith(b"tensor_file\0\1\0")
    assert main(["export", "sheet.json", "-o", "quiet.bsdf", "--wavelengths", "630,532,465", "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")


def test_endings_in_capitals_are_the_same_formats(folder):
    assert main(["export", "sheet.json", "-o", "SHEET.NPZ", "--quality", "preview", "--quiet"]) == 0
    assert load_npz("SHEET.NPZ").header["stack_hash"] == SHEET.hash
    assert main(["export", "sheet.json", "-o", "SHEET.BSDF", "--wavelengths", "630,532,465", "--quiet"]) == 0
    assert Path("SHEET.BSDF").read_bytes().startswith(b"tensor_file\0\1\0")


@pytest.mark.parametrize("arguments, sentence", [
    (["sheet.json", "-o", "out.exr"], "out.exr: must end in .npz or .bsdf"),
    (["sheet.json", "-o", "absent/out.npz"], "absent: not a folder that can be written to"),
    (["sheet.json", "-o", "out.npz", "--wavelengths", "500"], "only a .bsdf file has them"),
    (["sheet.json", "-o", "out.bsdf", "--wavelengths", "500,600"], "must be one for each of 3 channel"),
    (["sheet.json", "-o", "out.bsdf", "--wavelengths", "500,-1,600"], "must be positive nanometres"),
    (["two.json", "-o", "out.bsdf"], "the stack has 2 channels: a .bsdf file without wavelengths holds 1 or 3"),
])
def test_bad_words(folder, capfd, arguments, sentence):
    before = set(folder.iterdir())
    assert main(["export", *arguments]) == 2
    said = capfd.readouterr()
    assert sentence in said.err and said.out == "" and said.err.count("\n") == 1
    assert set(folder.iterdir()) == before
