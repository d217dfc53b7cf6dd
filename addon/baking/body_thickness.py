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
_MOST_FACES = 32  # that a ray meets
_THIN = 0.05  # share of the surface that is thinner
_KEY = "lamina_reach"  # of the group: the largest mean exit distance of a channel, in mm


def reach(found):
    """How far light travels, in mm: the largest mean exit distance of a channel of tables or inputs."""
    return float(np.max(found.distance))


def note(group, output, found):
    """Note on the material's lateral group how far light travels; `found` are the tables or inputs."""
    if output in _OFF:
        group[_KEY] = reach(found)
    elif _KEY in group:
        del group[_KEY]


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
    off = _OFF.get(material.lamina.lateral_shown, _OFF["PORTAL"])  # files of 0.1.0 note portals alone
    kinds = [layer.kind for layer in material.lamina.layers]
    # Other methods follow light through one medium below at most one interface.
    is_followed = kinds.count("medium") == 1 and kinds.count("interface") <= 1
    others = ". Choose Volume, or Exact" if is_followed else ""
    return (f"{obj.name} is {thickness:.3g} mm thick in thin parts, and light travels {reach:.3g} mm on "
            f"average: light from behind may be off by {off} %{others}")


def thin_part(evaluated):
    """The thickness that a twentieth of the surface does not reach, in Blender units; infinite for an open
    mesh, without faces, and for curves and the like."""
    if evaluated.type != "MESH":
        return np.inf
    mesh, matrix = evaluated.data, evaluated.matrix_world.to_3x3()
    count = len(mesh.polygons)
    if not count:
        return np.inf
    lengths, areas = [], []
    # Some faces only: a panel that is drawn often asks for this.
    for number in np.unique(np.linspace(0, count - 1, _RAYS).astype(int)):
        polygon = mesh.polygons[int(number)]
        # Parts that overlap, such as eyes in a head, are one body. Its surface is what lies in no other part.
        if sum(1 if leaves else -1 for _, leaves in _faces(evaluated, polygon, polygon.normal)) > 0:
            continue
        end, parts = None, 1
        for place, leaves in _faces(evaluated, polygon, -polygon.normal):
            parts += -1 if leaves else 1
            if parts == 0:
                end = place
                break
        lengths.append(np.inf if end is None else (matrix @ (end - polygon.center)).length)
        areas.append(polygon.area)
    if not areas:
        return np.inf
    order = np.argsort(lengths)
    thinner = np.cumsum(np.array(areas)[order])
    return float(np.array(lengths)[order][np.searchsorted(thinner, _THIN * thinner[-1])])


def _faces(evaluated, polygon, way):
    """(place, True if the ray leaves a part there) of the faces that a ray from the middle of one meets."""
    place, off = polygon.center, 1e-3 * polygon.area**0.5
    for _ in range(_MOST_FACES):
        hit, place, normal, index = evaluated.ray_cast(place + off * way, way)
        if not hit:
            return
        if index != polygon.index:  # the middle of a bent face is not on its triangles
            yield place, normal.dot(way) > 0.0
