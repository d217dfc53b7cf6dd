# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of settled dust, summed over blocks of points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..kinds.dust import Settling
from .balance import Forward

KEEPS_ALL = 0.95  # share of the grains; an occluder that stops more is named


@dataclass(frozen=True)
class Statistics:
    """Totals of settling. Masses are optical thickness times area in m^2; the first four need areas, and are None for
    points without areas.

    arrived = deposited + slid + wiped, summed over the points. By separate rays, traced from above along `grains`
    grains: launched = fell + behind + stopped + missed. `fell`: on faces from the side that takes dust; `behind`: on
    their other side; `stopped`: on occluders; `fell_stderr`: standard error of `fell`. arrived and fell are two
    estimates of one quantity; they differ by this error and by the coarseness of the mesh. `keepers`: names of
    occluders that alone stop nearly all grains, as a closed dome does."""

    points: int
    rays: int
    seconds: float
    mean: float  # optical thickness; a mean over area if areas are known
    maximum: float
    covered: float  # share of the points (of the area) with more than 1 % of the amount
    arrived: float | None
    deposited: float | None
    slid: float | None
    wiped: float | None
    launched: float
    fell: float
    fell_stderr: float
    behind: float
    stopped: float
    missed: float
    grains: int
    keepers: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def rays_per_second(self) -> float:
        return self.rays / self.seconds if self.seconds > 0.0 else 0.0

    def __str__(self) -> str:
        return (f"optical thickness {self.mean:.3g} on average, {self.maximum:.3g} at most, {100 * self.covered:.0f} % "
                f"covered; {self.points:,} points, {self.rays:,} rays in {self.seconds:.1f} s")


class Sums:
    """Sums over blocks of points, in their sequence."""

    def __init__(self, settings: Settling):
        self.settings = settings
        self.points, self.maximum = 0, 0.0
        self.has_areas = True
        self._plain = np.zeros(2)  # sums over points: thickness and coverage
        self._by_area = np.zeros(7)  # sums over area: area, thickness, coverage, arrived, deposited, slid, wiped

    def add(self, arrived: np.ndarray, stays: np.ndarray, left: np.ndarray, areas: np.ndarray | None) -> None:
        """(n,) each: optical thickness of arriving dust, the share of it that does not slide, and the share of the rest
        that is not wiped off."""
        tau = arrived * stays * left
        covered = tau > 0.01 * self.settings.tau
        self.points += len(tau)
        self.maximum = max(self.maximum, float(tau.max(initial=0.0)))
        self._plain += tau.sum(), covered.sum()
        if areas is None:
            self.has_areas = False
        else:
            slid, wiped = arrived * (1.0 - stays), arrived * stays * (1.0 - left)
            self._by_area += [areas @ x for x in (np.ones(len(tau)), tau, covered, arrived, tau, slid, wiped)]

    def statistics(self, forward: Forward, names: list[str], traced: int, seconds: float, notes=()) -> Statistics:
        """`names`: of the occluders; `notes`: further notes."""
        weight, mean, share = self._by_area[:3]
        if not (self.has_areas and weight > 0.0):
            weight, mean, share = max(self.points, 1), *self._plain
        masses = tuple(float(x) for x in self._by_area[3:]) if self.has_areas else (None,) * 4
        fell, behind, stderr = forward.front, forward.back, forward.front_stderr
        if self.settings.two_sided:
            fell, behind, stderr = fell + behind, 0.0, forward.both_stderr
        amount = self.settings.tau
        keepers = tuple(name for name, area in zip(names, forward.stopped_by, strict=True)
                        if area > KEEPS_ALL * forward.launched)
        told = (*_notes(masses[0], amount, fell, behind, stderr, keepers), *notes)
        return Statistics(
            points=self.points, rays=traced + forward.grains, seconds=seconds, mean=float(mean / weight),
            maximum=float(self.maximum), covered=float(share / weight), arrived=masses[0], deposited=masses[1],
            slid=masses[2], wiped=masses[3], launched=amount * forward.launched, fell=amount * fell,
            fell_stderr=amount * stderr, behind=amount * behind, stopped=amount * sum(forward.stopped_by),
            missed=amount * forward.missed, grains=forward.grains, keepers=keepers, notes=told)


def _notes(arrived: float | None, amount: float, fell: float, behind: float, stderr: float, keepers: tuple[str, ...]):
    for name in keepers:
        yield f"{name} keeps nearly all dust off: leave it out if it is a dome or a backdrop"
    if behind > 0.05 * (fell + behind):
        yield (f"{100.0 * behind / (fell + behind):.0f} % of the dust meets the back of faces, where none is laid: "
               "their normals may be turned, or the surface needs two sides")
    if arrived is None or amount == 0.0:
        return
    if arrived / amount > 100.0 * fell:
        yield ("nearly no dust that falls meets the mesh, though its points see some: another surface may lie on it, "
               "or the mesh is coarse")
    elif abs(arrived / amount - fell) > 0.1 * fell + 5.0 * stderr:
        yield (f"the points sum to {arrived / (amount * fell):.2f} times the dust that falls: the mesh is coarse, or "
               "its normals are not those of its faces")
