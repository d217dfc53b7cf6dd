# SPDX-License-Identifier: GPL-3.0-or-later
"""The searchlight against photons at equal error: CPU seconds of one thread for the flux in rings about the beam."""

import time

import numpy as np

import lamina
from lamina import HalfSpace, HenyeyGreenstein, Interface, Lambert, Medium, Stack

PHOTONS = 1 << 20
RINGS = 20
RUNS = 16  # runs of photons, which give their variance
PROMISED = 1e-3  # relative error of a profile at quality "final"
STACKS = {
    "half-space, albedo .9, isotropic": Stack([], HalfSpace(sigma_s=0.9, sigma_a=0.1)),
    "slab, albedo .9, g .75, 2 mean free paths": Stack(
        [Medium(sigma_s=0.9, sigma_a=0.1, thickness=2.0, phase=HenyeyGreenstein(0.75))]),
    "two layers, RGB, under a boundary": Stack(
        [Interface(1.4),
         Medium(sigma_s=[20.0, 22.0, 25.0], sigma_a=[0.2, 0.6, 1.2], thickness=0.1, phase=HenyeyGreenstein(0.8)),
         Medium(sigma_s=[8.0, 10.0, 14.0], sigma_a=[0.02, 0.1, 0.25], thickness=2.0, phase=HenyeyGreenstein(0.8))],
        Lambert(0.5)),
}


def measure(photons: int = PHOTONS, stacks: int | None = None) -> list[dict]:
    """Rows of the first `stacks`."""
    return [row for name, stack in list(STACKS.items())[:stacks] for row in rows_of(name, stack, photons)]


def rows_of(name: str, stack: Stack, photons: int) -> list[dict]:
    """One row per quality. The error is the largest of the rings' relative errors: for "preview" the difference from
    "final", for "final" the promised .1 %, which tests/lamina/lateral checks."""
    beams, seconds = {}, {}
    for quality in ("preview", "final"):
        began = time.process_time()
        beams[quality] = lamina.searchlight(stack, quality=quality, threads=1)
        seconds[quality] = time.process_time() - began
    radii = ring_radii(beams["final"])
    rings = {quality: ring_flux(beam, radii) for quality, beam in beams.items()}
    errors = {"preview": float(np.max(np.abs(rings["preview"] / rings["final"] - 1.0))), "final": PROMISED}
    walking, variance = photon_cost(stack, radii, photons)
    return [{"name": name, "quality": quality, "CPU-s": seconds[quality], "error": error,
             "photons, CPU-s to this error": variance * walking / error**2,
             "times sooner": variance * walking / error**2 / seconds[quality]} for quality, error in errors.items()]


def photon_cost(stack: Stack, radii: np.ndarray, photons: int) -> tuple[float, float]:
    """(CPU seconds per photon, relative variance of one photon in the ring with the largest variance)."""
    began = time.process_time()
    rings = np.stack([np.diff(_columns(lamina.estimate_searchlight(stack, r=radii, samples=photons // RUNS, seed=seed,
                                                                  threads=1).reflected_inside.value), axis=0)
                      for seed in range(RUNS)])
    seconds = time.process_time() - began
    relative = rings.var(axis=0, ddof=1) / rings.mean(axis=0) ** 2
    return seconds / photons, float(relative.mean(axis=-1).max()) * photons / RUNS


def ring_radii(beam: lamina.Searchlight) -> np.ndarray:
    """Radii between which each of RINGS rings has about the same flux, mean over channels; the outermost ring ends
    where 95 % of the light has left."""
    tried = np.geomspace(1e-3, 1e2, 400) * float(np.mean(beam.mean_distance))
    share = np.mean(_columns(beam.reflected_inside(tried) - beam.mirrored) / (beam.reflectance - beam.mirrored), axis=1)
    return np.interp(np.linspace(0.02, 0.95, RINGS + 1), share, tried)


def ring_flux(beam: lamina.Searchlight, radii: np.ndarray) -> np.ndarray:
    return np.diff(_columns(beam.reflected_inside(radii)), axis=0)


def _columns(values: np.ndarray) -> np.ndarray:
    """[radius, channel]."""
    return values.reshape(len(values), -1)


if __name__ == "__main__":
    for row in measure():
        print(row)
