# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin in Mitsuba's LLVM variants, in a process of its own: an LLVM library that is too old ends it."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

LIBRARY = "DRJIT_LIBLLVM_PATH"
FOLDERS = ("/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64")


def library() -> str | None:
    """An LLVM library of version 16 or newer; 14 and 15 abort."""
    found = [path for folder in FOLDERS for path in Path(folder).glob("libLLVM*.so*")
             if int((re.search(r"(\d+)", path.name.removeprefix("libLLVM")) or [0, 0])[1]) >= 16]
    return os.environ.get(LIBRARY) or (str(found[0]) if found else None)


@pytest.mark.skipif(library() is None, reason="this system has no libllvm19")
def test_values_and_density():
    ran = subprocess.run([sys.executable, __file__], env={**os.environ, LIBRARY: str(library())}, capture_output=True,
                         text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    assert {"values", "chi-squared", "spectral"} <= set(ran.stdout.splitlines())


def checks() -> None:
    import drjit as dr
    import mitsuba as mi
    import numpy as np

    import lamina
    from lamina.mitsuba import RenderTable, bsdf

    def places(wi, count):
        place = dr.zeros(mi.SurfaceInteraction3f, count)
        place.wi = mi.Vector3f(wi)
        return place

    mi.set_variant("llvm_ad_rgb")
    sheet = lamina.Stack([lamina.Medium((0.9, 0.6, 0.3), 0.7, lamina.HenyeyGreenstein(0.8))])
    table = RenderTable.of(lamina.solve(sheet), "preview")
    mine, random = bsdf(table), np.random.default_rng(1)
    for number, (side, path) in enumerate(table.sights):
        view, light = (part / np.linalg.norm(part, axis=1)[:, None] for part in random.normal(size=(2, 500, 3)))
        view[:, 2] = np.abs(view[:, 2])
        light[:, 2] = np.abs(light[:, 2]) * (1.0 if path == "reflect" else -1.0)
        turned = [1.0, 1.0, 1.0 if side == "top" else -1.0]
        wanted = table.values(number, view, light) * np.abs(light[:, 2:])
        got = mine.eval(mi.BSDFContext(), places((view * turned).T, 500), mi.Vector3f((light * turned).T))
        np.testing.assert_allclose(np.array(got).T, wanted, rtol=2e-5, atol=1e-6 * wanted.max())
    print("values")

    # What is not specular; light that falls below the horizon is not counted, in samples and in the density.
    for stack in (sheet, lamina.Stack([lamina.Interface(1.5, 0.1), lamina.Medium(0.9, 1.0)], lamina.Lambert(0.5))):
        mine = bsdf(RenderTable.of(lamina.solve(stack, "preview"), "preview"))
        context = mi.BSDFContext()
        context.type_mask = int(mi.BSDFFlags.Glossy)
        view = [0.8, 0.0, 0.6]

        def drawn(sample, mine=mine, context=context, view=view):
            place = places(view, dr.width(sample))
            found, weight = mine.sample(context, place, sample.x, mi.Point2f(sample.y, sample.z))
            return found.wo, dr.select(dr.any(weight != 0.0), 1.0, 0.0)

        test = mi.chi2.ChiSquareTest(
            domain=mi.chi2.SphericalDomain(), sample_func=drawn, sample_dim=3, sample_count=300000, res=51, ires=16,
            pdf_func=lambda light, mine=mine, context=context, view=view: mine.pdf(
                context, places(view, dr.width(light)), light))
        assert test.run(), test.messages
    print("chi-squared")

    mi.set_variant("llvm_ad_spectral")
    stack = lamina.Stack([lamina.Medium((0.2, 0.5, 0.9), 0.8)], lamina.Lambert(0.3), wavelengths=(450.0, 650.0, 550.0))
    table = RenderTable.of(lamina.solve(stack), "preview")
    place = places([0.0, 0.6, 0.8], 1)
    place.wavelengths = mi.Spectrum(450.0, 550.0, 600.0, 700.0)
    light = np.array([[0.6, 0.0, 0.8]])
    got = np.array(bsdf(table).eval(mi.BSDFContext(), place, mi.Vector3f(light.T))).ravel()
    low, high, middle = table.values(0, np.array([[0.0, 0.6, 0.8]]), light)[0] * 0.8
    np.testing.assert_allclose(got, [low, middle, 0.5 * (middle + high), high], rtol=1e-4)
    print("spectral")


if __name__ == "__main__":
    checks()
