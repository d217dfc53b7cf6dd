# SPDX-License-Identifier: GPL-3.0-or-later
"""The dust on the vertices of one mesh, whose rays are traced elsewhere, in parts of its points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..common.progress import Progress
from ..kinds.dust import Settling
from .balance import Forward
from .mesh import Mesh
from .rays import Starts, Traced
from .settle import Dust, blocks_of, collected, vertices_of
from .sky import Sky
from .statistics import Sums


class PartedDust:
    """The work of lamina.dust.settle on a checked surface before and after its rays. `place`: what the rays are traced
    in; `starts`: where they start, for all points; `window`: where grains start that are traced from above.

    Everything but the rays is done here, with the blocks of points of lamina.dust.settle, so that the bytes are its
    own. Raises DustError, DustUnavailable."""

    def __init__(self, surface: Mesh, occluders: list[Mesh], settings: Settling, seed: int, step: Progress):
        self._settings, self._seed = settings, seed
        self._sky = Sky(surface, occluders, settings, seed)
        self._corners, self._points = vertices_of(self._sky, step)
        pairs = [self._sky.starts(points) for _, _, points in blocks_of(self._points)]
        self.place, self.window = self._sky.place, self._sky.window()
        self.starts = Starts.joined([starts for starts, _ in pairs])
        self._stays = np.concatenate([stays for _, stays in pairs])

    def dust(self, parts: Sequence[Traced], forward: Forward) -> Dust:
        """`parts`: the rays of all points, in their sequence; `forward`: grains traced from above."""
        traced, sums = Traced.joined(parts), Sums(self._settings)

        def laid():
            for _, place, points in blocks_of(self._points):
                block = self._sky.laid(points, self._stays[place], traced.part(place.start, place.stop))
                sums.add(block.arrived, block.stays, block.left, points.areas)
                yield place, block

        def statistics():
            return sums.statistics(forward, self._sky.names, traced.rays, traced.seconds)

        return collected(len(self.starts), self._corners, laid(), statistics, self._settings, self._seed)
