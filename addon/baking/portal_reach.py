# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the light of a portal travels, compared with the size of the object.

The portal puts sources below the surface, as deep as on a flat body. In thin objects sources lie outside."""

# Mean exit distances in the thickness of an object. Measured: bodies 2.0 and 2.3 thick differ from Cycles'
# volume by 24 and 28 %, bodies 5 to 7 thick by 7 to 11 %.
LEAST = 3.0
_KEY = "lamina_reach"  # of the group: the largest mean exit distance of a channel, in mm


def note(group, output, found):
    """Note on the material's lateral group how far light travels, if `found` are the tables of a portal."""
    if output == "PORTAL":
        group[_KEY] = float(max(found.distance))
    elif _KEY in group:
        del group[_KEY]


def too_thin(obj, material, millimetre):
    """One sentence if the object is too thin for the material's portal, otherwise ''.
    `millimetre`: its length in Blender units."""
    group = material.lamina.lateral_group
    # Without a report, an interior has replaced the portal.
    reach = group.get(_KEY) if group is not None and material.lamina.lateral_report else None
    if reach is None or obj is None or obj.type != "MESH":
        return ""
    thickness = min(obj.dimensions) / millimetre
    if thickness >= LEAST * reach:
        return ""
    return (f"{obj.name} is {thickness:.3g} mm thick, too thin for Full Profile: light travels {reach:.3g} "
            "mm on average. Choose Mean Distance, or Exact")
