# SPDX-License-Identifier: GPL-3.0-or-later
"""A body under a sun that goes once around it. All positions of the sun share the same walks, so the noise of the walks
does not flicker from frame to frame."""

import bpy
from slab.light import frame

from . import portrait

EXPOSURE = 0.9  # less than that of the still picture: a sun in front of the stone lights it more than one behind


def frames(stone, made, effort, count):
    """Yields linear pixels (size, size, 3) for `count` positions of the stone's first sun; the other lamps stay."""
    first = stone.lamps[0]
    suns = [(first[0] + 360.0 * k / count, *first[1:]) for k in range(count)]
    studio = portrait.studio_of(stone, made, effort)
    light = portrait.walked(studio, [*map(portrait.sun_lamp, suns), *studio.lamps[1:]], effort)
    still = light.sky * stone.sky
    for of_lamp, strength in zip(light.lamps[count:], studio.strengths[1:], strict=True):
        still = still + of_lamp * strength
    for sun, of_sun in zip(suns, light.lamps, strict=False):
        studio.suns[0].matrix_world = frame(portrait.towards(sun))
        yield portrait.shown(studio, still + of_sun * sun[3])
    bpy.data.scenes.remove(studio.stage)
