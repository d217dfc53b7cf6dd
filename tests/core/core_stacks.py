# SPDX-License-Identifier: GPL-3.0-or-later
"""Short constructors of the core's media and bases."""

from lamina import _core


def medium(albedo, tau, kind, g=0.0):
    """A medium; g counts for Henyey-Greenstein only."""
    return _core.Medium(albedo, tau, kind, *([g] if kind == "hg" else []))


def base(lambert):
    """A Lambert base of this reflectance, or none."""
    return _core.Base.none() if lambert is None else _core.Base.lambert(lambert)


def stack(media, lambert=None):
    return _core.Stack([medium(*one) for one in media], base(lambert))


def thinnest(media):
    """Least thickness of the media, for solve_at."""
    return min(one[1] for one in media)
