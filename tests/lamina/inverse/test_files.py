# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of measurements: MERL, RGL, CSV."""

import math
import struct

import numpy as np
import pytest

import lamina
from lamina import Free, HenyeyGreenstein, Interface, Lambert, MeasurementError, Medium, Stack, Template
from lamina.common.tensor_file import write_tensors
from lamina.inverse.rgl import read_rgl
from lamina.measurements import Brdf, Btdf, Profile, Reflectance, Transmittance, load

MERL_SCALES = (1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0)


def merl_value(i, j, k):
    return 0.01 + (i * 90 + j) * 1e-4 + k * 1e-7


def merl_file(path, values=None, shape=(90, 90, 180)):
    i, j, k = np.indices((90, 90, 180))
    cells = merl_value(i, j, k) if values is None else values
    with path.open("wb") as file:
        file.write(struct.pack("<3i", *shape))
        for scale in MERL_SCALES:
            file.write((cells / scale).astype("<f8").tobytes())
    return path


def merl_cell(wi, wo):
    """The cell in which the format's own reader looks a direction up: rotations of the incoming direction by the
    azimuth and the angle of the half vector."""
    half = (wi + wo) / np.linalg.norm(wi + wo)
    theta, azimuth = math.acos(half[2]), math.atan2(half[1], half[0])
    c, s = math.cos(-azimuth), math.sin(-azimuth)
    turned = np.array([c * wi[0] - s * wi[1], s * wi[0] + c * wi[1], wi[2]])
    c, s = math.cos(-theta), math.sin(-theta)
    d = np.array([c * turned[0] + s * turned[2], turned[1], -s * turned[0] + c * turned[2]])
    phi = math.atan2(d[1], d[0]) % math.pi
    return (int(math.sqrt(theta / (0.5 * math.pi)) * 90.0), int(math.acos(d[2]) / (0.5 * math.pi) * 90.0),
            int(phi / math.pi * 180.0))


def vectors(mu_i, mu_o, dphi):
    wi = np.array([math.sqrt(1.0 - mu_i**2), 0.0, mu_i])
    sine = math.sqrt(1.0 - mu_o**2)
    return wi, np.array([-sine * math.cos(dphi), sine * math.sin(dphi), mu_o])


def test_merl_directions_lie_in_the_cells_of_their_values(tmp_path):
    (found,) = load(merl_file(tmp_path / "x.binary"), count=400, grazing=80.0, relative=0.02)
    assert found.values.shape == (400, 3) and found.mu_o.min() >= math.cos(math.radians(80.0))
    i, j, k = np.indices((90, 90, 180))
    by_value = merl_value(i, j, k)
    for value, mu_o, mu_i, dphi in zip(found.values[:, 0], found.mu_o, found.mu_i, found.dphi, strict=True):
        cells = {merl_cell(*vectors(mu_i, mu_o, sign * dphi)) for sign in (1.0, -1.0)}
        assert any(by_value[cell] == pytest.approx(value, abs=4e-8) for cell in cells), (cells, value)


def test_merl_leaves_unmeasured_cells_out(tmp_path):
    i, _, _ = np.indices((90, 90, 180))
    (found,) = load(merl_file(tmp_path / "x.binary", np.where(i < 45, 0.2, -1.0)), count=50, relative=0.02)
    assert np.all(found.values == pytest.approx(0.2))


def random_bsdf(path, jacobian=1, **changes):
    """A .bsdf file whose tables are all random, and even in the azimuth."""
    rng = np.random.default_rng(1)
    theta, size = np.array([0.1, 0.3, 0.7, 1.1, 1.4]), 9

    def even(low, high, shape):
        table = rng.uniform(low, high, shape)
        return 0.5 * (table + np.flip(table, axis=-2))

    fields = {"description": np.frombuffer(b"x", np.uint8), "jacobian": np.full(1, jacobian, np.uint8),
              "ndf": even(0.5, 2.0, (2, 7)), "sigma": even(0.5, 1.0, (2, 6)), "vndf": even(0.2, 2.0, (1, 5, 11, 8)),
              "phi_i": np.zeros(1), "theta_i": theta, "luminance": even(0.5, 1.0, (1, 5, size, size)),
              "rgb": even(0.1, 1.0, (1, 5, 3, size, size))}
    fields = {name: value for name, value in {**fields, **changes}.items() if value is not None}
    with path.open("wb") as file:
        write_tensors(file, fields)
    return path


@pytest.mark.parametrize("jacobian", [0, 1])
def test_rgl_values_are_those_of_mitsuba(tmp_path, jacobian):
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    path = random_bsdf(tmp_path / "x.bsdf", jacobian)
    found = read_rgl(path)
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(path)})
    at, context = mitsuba.SurfaceInteraction3f(), mitsuba.BSDFContext()
    compared = 0
    for values, mu_o, mu_i, dphi in zip(found.values, found.mu_o, found.mu_i, found.dphi, strict=True):
        if mu_o < 0.05 or (abs(mu_o - mu_i) < 1e-6 and dphi < 1e-3):
            continue  # near the horizon, and where the half vector is the normal, whose azimuth is undefined
        wi, wo = vectors(mu_i, mu_o, dphi)
        at.wi = mitsuba.Vector3f(*wi)
        assert np.array(bsdf.eval(context, at, mitsuba.Vector3f(*wo))) / mu_o == pytest.approx(values, rel=1e-3)
        compared += 1
    assert compared > 150


def test_a_stack_comes_back_from_its_own_bsdf_file(tmp_path):
    def paint(albedo, tau):
        return [Interface(1.5, alpha=0.2), Medium(albedo=albedo, tau=tau, phase=HenyeyGreenstein(0.4))], Lambert(0.3)
    lamina.rgl.save_bsdf(Stack(*paint([0.9, 0.7, 0.5], 2.0)), tmp_path / "paint.bsdf", size=64, angles=16)
    measured = load(tmp_path / "paint.bsdf", count=60, grazing=60.0, relative=0.01)
    free = [Free(0.8, 0.0, 1.0) for _ in range(3)]
    fit = lamina.fit(measured, Template(*paint(free, Free(1.0, 0.1, 10.0, "tau"))))
    assert list(fit.values.values()) == pytest.approx([0.9, 0.7, 0.5, 2.0], rel=0.03)


def test_wavelengths_of_a_bsdf_file(tmp_path):
    spectra = np.stack([np.full((5, 9, 9), value) for value in (1.0, 2.0, 4.0)], axis=1)[None]
    path = random_bsdf(tmp_path / "x.bsdf", 0, rgb=None, spectra=spectra, wavelengths=np.array([400.0, 500.0, 700.0]))
    (found,) = load(path, count=10, wavelengths=[450.0, 700.0], relative=0.1)
    assert found.values * found.mu_o[:, None] == pytest.approx(np.tile([1.5, 4.0], (10, 1)))
    assert load(path, count=10, relative=0.1)[0].channels == 3
    with pytest.raises(lamina.ArgumentError, match=r"wavelengths hold 800: must lie in \[400, 700\] nm"):
        load(path, wavelengths=[800.0], relative=0.1)


@pytest.mark.filterwarnings("error")
def test_one_wavelength_of_a_bsdf_file(tmp_path):
    """Between one wavelength and itself, 0 was divided by 0."""
    lamina.rgl.save_bsdf(Stack([], Lambert(0.3)), tmp_path / "x.bsdf", size=8, angles=4, wavelengths=[550.0])
    (found,) = load(tmp_path / "x.bsdf", count=10, wavelengths=[550.0], relative=0.1)
    assert found.values * math.pi == pytest.approx(np.full((10, 1), 0.3), rel=1e-4)


def written(tmp_path, text):
    path = tmp_path / "x.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_csv(tmp_path):
    both = load(written(tmp_path, """# a gonioreflectometer
theta_i_deg, theta_o_deg, dphi_deg, brdf_r, brdf_g, sigma_brdf_r, sigma_brdf_g, btdf_r, btdf_g, relative
45, 0, 0, .1, .2, .01, .02, .3, .4, .05
60, 10, 180, .3, .4, .03, .04, .5, .6, .05
"""))
    assert [type(one) for one in both] == [Brdf, Btdf]
    assert both[0].mu_i == pytest.approx([math.sqrt(0.5), 0.5]) and both[0].dphi == pytest.approx([0.0, math.pi])
    assert both[0].values.tolist() == [[0.1, 0.2], [0.3, 0.4]]
    assert both[0].sigma.tolist() == [[0.01, 0.02], [0.03, 0.04]]
    assert both[1].relative.tolist() == [[0.05] * 2] * 2 and np.all(both[1].sigma == 0.0)
    white, through = load(written(tmp_path, "reflectance,transmittance\n.4,.3\n"), sigma=0.01,
                          changes={"base": Lambert(0.9)})
    assert (type(white), type(through), white.mu_i) == (Reflectance, Transmittance, "diffuse")
    assert through.changes == {"base": Lambert(0.9)}
    (beam,) = load(written(tmp_path, "r_mm,mu_i,reflected_per_mm2,sigma\n1,1,.2,.01\n2,1,.1,.01\n"))
    assert type(beam) is Profile and beam.r.tolist() == [1.0, 2.0]
    (angle,) = load(written(tmp_path, "theta_i_rad,reflectance\n.5,.2\n1.0,.3\n"), relative=0.1)
    assert angle.mu_i == pytest.approx(np.cos([0.5, 1.0]))


@pytest.mark.parametrize(("names", "values"), [
    (("blue", "red", "green"), [2.0, 3.0, 1.0]), (("g", "b", "r"), [3.0, 1.0, 2.0]), (("b", "r"), [2.0, 1.0]),
    (("red", "g"), [1.0, 2.0]), (("650nm", "550nm", "450nm"), [1.0, 2.0, 3.0])])
def test_the_sequence_of_channels_in_csv(tmp_path, names, values):
    columns = ",".join(f"brdf_{name}" for name in names), ",".join(f"sigma_brdf_{name}" for name in names)
    numbers = [str(number + 1) for number in range(len(names))]
    text = f"mu_o,mu_i,dphi_deg,{','.join(columns)}\n1,1,0,{','.join([*numbers, *numbers])}\n"
    (found,) = load(written(tmp_path, text))
    assert found.values.tolist() == found.sigma.tolist() == [values]


@pytest.mark.parametrize(("text", "message"), [
    ("", "must have a line with the names of columns"),
    ("brdf\n", "must have a line with the names of columns"),
    ("theta_i,reflectance\n1,1\n", "column 'theta_i' is unknown; similar ones are theta_i_"),
    ("reflectance,reflectance\n1,1\n", "two columns are called 'reflectance'"),
    ("mu_i\n1\n", "no column of values: must have one of brdf"),
    ("mu_i,brdf\n1,1\n", "a column of brdf needs a column mu_o or theta_o_deg or theta_o_rad"),
    ("mu_i,reflectance\n1,.5,2\n", "line 2 has 3 entries: must have 2"),
    ("mu_i,reflectance\n1,x\n", "line 2, reflectance = 'x': must be a finite number"),
    ("mu_i,reflectance\n# no\n1,nan\n", "line 3, reflectance = 'nan': must be a finite number"),
    ("mu_i,reflectance\n1,-0.5\n", "reflectance: values hold -0.5 .* must not be negative"),
    ("mu_i,reflectance\n1,55\n", "must be at most 1; shares are not given in percent"),
    ("mu_i,reflectance\n60,.5\n", "mu_i = 60: must be a cosine in"),
    ("theta_i_rad,reflectance\n60,.5\n", r"theta_i_rad = 60: .* are these degrees\? then call the column theta_i_deg"),
    ("theta_i_deg,reflectance\n91,.5\n", r"theta_i_deg = 91: must lie in \[0, 90\)"),
    ("theta_i_deg,reflectance\n" + "".join(f"{angle},.5\n" for angle in (0.1, 0.5, 0.9, 1.3)),
     r"no angle above 1.3: are these radians\? then call the column theta_i_rad"),
    ("theta_i_deg,theta_o_deg,dphi_rad,brdf\n10,10,90,.1\n", r"dphi_rad = 90: .* are these degrees\?"),
    ("reflectance\n.1\n.2\n", "2 lines of reflectance without an angle"),
    ("mu_i,reflectance_a,reflectance_b,sigma_reflectance_a\n1,.1,.2,.01\n", "only some columns of reflectance have"),
    ("mu_i,theta_i_deg,reflectance\n.5,10,.1\n", "theta_i_deg: an earlier column gives the same, in another unit"),
    ("mu_i,reflectance\n" + 200_000 * "1" + ",.1\n", "text of comma-separated values: field larger than field limit"),
    ("r_mm,mu_i,reflected_per_mm2\n1,1,.1\n2,.5,.1\n", "the angle of the beam differs between lines"),
])
def test_bad_csv_gets_one_sentence(tmp_path, text, message):
    with pytest.raises(MeasurementError, match=message) as error:
        load(written(tmp_path, text), relative=0.01)
    assert "\n" not in str(error.value) and "x.csv: " in str(error.value)


FITS_NOT = "shapes that do not fit together"
NO_DENSITY = "holds numbers that cannot be densities or areas"
NOT_ASCENDING = "holds numbers that do not ascend, or cannot be"
DAMAGES = {
    "no grid of densities": ({"vndf": np.ones(1)}, FITS_NOT),
    "one axis too many": ({"vndf": np.ones((1, 1, 5, 11, 8))}, FITS_NOT),
    "densities of one column": ({"vndf": np.ones((1, 5, 11, 1))}, FITS_NOT),
    "densities for other angles": ({"vndf": np.ones((1, 4, 11, 8))}, FITS_NOT),
    "a list of normals": ({"ndf": np.ones(7)}, FITS_NOT),
    "no areas": ({"sigma": np.ones((0, 6))}, FITS_NOT),
    "no azimuths": ({"phi_i": np.empty(0), "vndf": np.ones((0, 5, 11, 8)), "rgb": np.ones((0, 5, 3, 9, 9))}, FITS_NOT),
    "spectra without wavelengths": ({"spectra": np.ones((1, 5, 2, 9, 9))},
                                    "has no 'wavelengths': must be a .bsdf file of RGL"),
    "no angles": ({"theta_i": np.empty(0)}, FITS_NOT),
    "a table of angles": ({"theta_i": np.ones((1, 5))}, FITS_NOT),
    "four colors": ({"rgb": np.ones((1, 5, 4, 9, 9))}, FITS_NOT),
    "densities that are no numbers": ({"vndf": np.full((1, 5, 11, 8), np.nan)}, f"vndf {NO_DENSITY}"),
    "no densities": ({"vndf": np.zeros((1, 5, 11, 8))}, f"vndf {NO_DENSITY}"),
    "negative areas": ({"sigma": np.full((2, 6), -1.0)}, f"sigma {NO_DENSITY}"),
    "endless normals": ({"ndf": np.full((2, 7), np.inf)}, f"ndf {NO_DENSITY}"),
    "a value that is no number": ({"rgb": np.where(np.arange(9) == 8, np.nan, np.ones((1, 5, 3, 9, 9)))},
                                  "values that are not finite"),
    "angles that fall": ({"theta_i": np.array([1.4, 1.1, 0.7, 0.3, 0.1])}, f"theta_i {NOT_ASCENDING}"),
    "angles in degrees": ({"theta_i": np.array([6.0, 17.0, 40.0, 63.0, 80.0])}, f"theta_i {NOT_ASCENDING}"),
    "angles that are no numbers": ({"theta_i": np.full(5, np.nan)}, f"theta_i {NOT_ASCENDING}"),
    "wavelengths that fall": ({"rgb": None, "spectra": np.ones((1, 5, 2, 9, 9)),
                               "wavelengths": np.array([500.0, 400.0])}, f"wavelengths {NOT_ASCENDING}"),
    "a wavelength too many": ({"rgb": None, "spectra": np.ones((1, 5, 2, 9, 9)),
                               "wavelengths": np.array([400.0, 500.0, 600.0])}, FITS_NOT),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("damage", DAMAGES)
def test_arrays_of_a_bsdf_file_that_cannot_be(tmp_path, damage):
    """Some gave values of other directions, warnings of NumPy, or its errors."""
    changes, words = DAMAGES[damage]
    path = random_bsdf(tmp_path / "x.bsdf", **changes)
    for call in (lambda: load(path, relative=0.01), lambda: lamina.measurements.load_base(path)):
        with pytest.raises(MeasurementError, match=rf"x\.bsdf: .*{words}$"):
            call()


def test_bad_files_get_one_sentence(tmp_path):
    def refused(path, message, **options):
        with pytest.raises(MeasurementError, match=message) as error:
            load(path, relative=0.01, **options)
        assert "\n" not in str(error.value)

    (tmp_path / "x.mat").write_bytes(b"x")
    refused(tmp_path / "x.mat", r"unknown format: must be .binary \(MERL\), .bsdf \(RGL\) or .csv")
    for name, message in (("x.binary", "must be a .binary file of MERL"), ("x.bsdf", "must be a .bsdf file of RGL"),
                          ("x.csv", "must be a text of comma-separated values")):
        (tmp_path / name).write_bytes(b"\xff\xfe\x00rubbish")
        refused(tmp_path / name, message)
    refused(merl_file(tmp_path / "y.binary", np.full((90, 90, 180), -1.0)), "no value up to 75 degrees")
    refused(merl_file(tmp_path / "y.binary", np.full((90, 90, 180), np.nan)), "not finite")
    refused(merl_file(tmp_path / "y.binary", shape=(45, 90, 180)), "must be a .binary file of MERL")
    good = random_bsdf(tmp_path / "y.bsdf").read_bytes()
    for length in (15, 100, len(good) // 2, len(good) - 1):
        (tmp_path / "z.bsdf").write_bytes(good[:length])
        refused(tmp_path / "z.bsdf", "must be a .bsdf file of RGL: the file is truncated or damaged")
    refused(random_bsdf(tmp_path / "y.bsdf", vndf=None), "has no 'vndf'")
    refused(random_bsdf(tmp_path / "y.bsdf", rgb=None), "has no 'rgb'")
    refused(random_bsdf(tmp_path / "y.bsdf", phi_i=np.zeros(4)), "holds an anisotropic material")
    refused(random_bsdf(tmp_path / "y.bsdf", rgb=np.ones((1, 2, 3, 9, 9))), "shapes that do not fit together")
    refused(random_bsdf(tmp_path / "y.bsdf", rgb=np.full((1, 5, 3, 9, 9), -1.0)), "must not be negative")
    with pytest.raises(lamina.ArgumentError, match="wavelengths = .* only a .bsdf file has them"):
        load(tmp_path / "x.csv", wavelengths=[500.0])
    with pytest.raises(lamina.ArgumentError, match="grazing = 90"):
        load(tmp_path / "x.bsdf", grazing=90.0)
