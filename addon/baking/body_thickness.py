# SPDX-License-Identifier: GPL-3.0-or-later
"""How thick an object is, by rays inwards, compared with the way of light below its surface.

On thin parts, Mean Distance and Full Profile are wrong where light comes from behind: both know flat bodies
alone."""

import numpy as np

# Mean exit distances in the thickness of thin parts. Measured against Cycles' volume with a sun behind:
# plates and tori .6 to 3.7 thick differ by up to _OFF percent, a cube of 12 by 22 and 29 %; under a sky by 1
# and 19 %.
LEAST = 6.0
_OFF = {"RELIGHTABLE": 78, "PORTAL": 76}
_RAYS = 200
_THIN = 5.0  # percentile of the rays' lengths
_KEY, _OUTPUT = "lamina_reach", "lamina_reach_of"  # of the group: the largest mean exit distance, in mm


def note(group, output, found):
    """Note on the material's lateral group how far light travels; `found` are the tables or inputs."""
    for key in (_KEY, _OUTPUT):
        if key in group:
            del group[key]
    if output in _OFF:
        group[_KEY], group[_OUTPUT] = float(np.max(found.distance)), output


def too_thin(obj, material, depsgraph, millimetre):
    """One sentence if the object is too thin for the material's lateral nodes, otherwise ''.
    `millimetre`: its length in Blender units."""
    group = material.lamina.lateral_group
    # Without a report, an interior has replaced these nodes.
    reach = group.get(_KEY) if group is not None and material.lamina.lateral_report else None
    if reach is None or obj is None or obj.type != "MESH":
        return ""
    thickness = thin_part(obj.evaluated_get(depsgraph)) / millimetre
    if not thickness < LEAST * reach:
        return ""
    off = _OFF[group.get(_OUTPUT, "PORTAL")]
    return (f"{obj.name} is {thickness:.3g} mm thick in thin parts, and light travels {reach:.3g} mm on "
            f"average: light from behind may be off by {off} %. Choose Volume, or Exact")


def thin_part(evaluated):
    """The thickness that a twentieth of the surface does not reach, in Blender units; infinite for an open
    mesh or without faces."""
    mesh, matrix = evaluated.data, np.array(evaluated.matrix_world.to_3x3())
    count = len(mesh.polygons)
    if not count:
        return np.inf
    areas = np.empty(count, np.float32)
    mesh.polygons.foreach_get("area", areas)
    ends = np.cumsum(areas, dtype=np.float64)
    if not ends[-1] > 0.0:
        return np.inf
    lengths = []
    for face in np.searchsorted(ends, (np.arange(_RAYS) + 0.5) / _RAYS * ends[-1]):
        polygon = mesh.polygons[int(face)]
        inwards, off = -polygon.normal, float(1e-5 * areas[face] ** 0.5)
        hit, place, *_ = evaluated.ray_cast(polygon.center + off * inwards, inwards)
        lengths.append(np.linalg.norm(matrix @ np.array(place - polygon.center)) if hit else np.inf)
    return float(np.percentile(lengths, _THIN, method="lower"))
