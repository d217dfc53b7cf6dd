# SPDX-License-Identifier: GPL-3.0-or-later
"""24 Principled materials under dust and varnish, baked and rendered in Cycles, against lamina.solve of the same stack:

    python bench/principled_table.py [--quality preview|final] [--only FIRST LAST]
        [--layers all|dust|varnish] [--no-times]

Prints a table: for each material and layer the mean relative L2 error of slices at three views, the mean error that a
bake of the same stack with fixed numbers reports, the largest error of the directional albedo, and for thickness 0 the
largest difference from the Principled BSDF alone; then the CPU time of a render of the group relative to the BSDF
alone. The last lines say for each layer how many materials hold the limits. Slices leave out lights within 20 degrees
of the mirror direction for a coat, which is a mirror in the solver, and are not measured for facets narrower than alpha
.03."""

import argparse
import itertools
import os
import sys
import tempfile
import time
from pathlib import Path

RESOURCES = Path(tempfile.mkdtemp(prefix="lamina-blender-"))
os.environ["BLENDER_USER_RESOURCES"] = str(RESOURCES)
ROOT = Path(__file__).resolve().parent.parent
(RESOURCES / "extensions" / "user_default").mkdir(parents=True)
(RESOURCES / "extensions" / "user_default" / "lamina").symlink_to(ROOT / "addon", target_is_directory=True)
sys.path.insert(0, str(ROOT / "tests" / "cycles"))

import bpy  # noqa: E402, I001 (its scripts hold addon_utils)
import addon_utils  # noqa: E402
import baked_samples  # noqa: E402
import goniophotometer  # noqa: E402
import numpy as np  # noqa: E402
import principled_samples  # noqa: E402
from test_principled_law import principled  # noqa: E402

import lamina  # noqa: E402
from lamina import HenyeyGreenstein, Interface, Medium, PrincipledBase  # noqa: E402

DUST = Medium(albedo=[0.9, 0.88, 0.84], tau=2.0, phase=HenyeyGreenstein(0.6), varying=True)
THICKNESSES = (0.0, 0.1, 0.5, 2.0)
RED, BLUE, DARK = (0.8, 0.4, 0.1), (0.2, 0.6, 0.9), (0.05, 0.04, 0.03)
ROUGHNESSES = (0.1, 0.25, 0.4, 0.6, 0.8)
MATERIALS = [
    *(PrincipledBase(color=RED, metallic=m, roughness=r) for m in (0.0, 1.0) for r in ROUGHNESSES),
    *(PrincipledBase(color=BLUE, metallic=m, roughness=r, inputs=("color", "metallic", "roughness"))
      for m in (0.0, 1.0) for r in (0.3, 0.5, 0.7)),
    *(PrincipledBase(color=RED, metallic=m, roughness=r, inputs=("color",)) for m, r in ((0.0, 0.2), (1.0, 0.35))),
    PrincipledBase(color=DARK, roughness=0.5), PrincipledBase(color=0.95, metallic=1.0, roughness=0.5),
    PrincipledBase(color=RED, metallic=0.5, roughness=0.5), PrincipledBase(color=RED, specular=0.2),
    PrincipledBase(color=RED, roughness=0.5, coat=1.0),
    PrincipledBase(color=RED, metallic=1.0, roughness=0.5, coat=0.5),
]
assert len(MATERIALS) == 24
VARNISH, ROUGH_VARNISH = Interface(ior=1.5), Interface(ior=1.5, alpha=0.15)
VIEWS = baked_samples.gauss_views(3)
LIGHTS = baked_samples.about_the_mirror_direction(VIEWS, 3, 6, 3.0)
FURNACE_VIEWS = (0.9, 0.5, 0.2)
# Limits of the mean error of slices, of its ratio to a bake with fixed numbers, and of the albedo.
MEAN_SLICE, OF_FIXED, ALBEDO = 0.06, 1.5, 0.02


def slices_of(shown):
    """Mean error over views and channels, without lights near the mirror direction where the solver has a mirror."""
    found = []
    for one in shown:
        lights = LIGHTS
        if one.base.alpha == 0.0:
            found.append(float("nan"))
            continue
        if one.base.coat > 0.0:
            away = np.hypot(np.arccos(LIGHTS.mu) - np.arccos(VIEWS.mu)[:, None], LIGHTS.dphi) > np.radians(20.0)
            lights = baked_samples.Lights(LIGHTS.mu, LIGHTS.dphi, LIGHTS.solid_angle * away)
        found.append(VIEWS.mean(principled_samples.slice_errors([one], VIEWS, lights)[0]))
    return found


def difference_from_the_bsdf(shown, base):
    values = {name: getattr(base, name) for name in ("color", "metallic", "roughness", "specular", "coat")}
    values["color"] = np.broadcast_to(base.color, 3)
    bare = principled("bare", values)
    worst = 0.0
    for direction in ((0.9, 0.8, 0.1), (0.5, 0.5, 0.0), (0.2, 0.3, 2.0)):
        one, other = goniophotometer.measure_many([shown.material, bare], *direction, samples=1)
        worst = max(worst, float(np.abs(one / other - 1.0).max()))
    return worst, bare


def seconds(material):
    """The least CPU time of three renders of patches under a sky."""
    found = []
    for _ in range(3):
        started = time.process_time()
        goniophotometer.furnace_many([material] * 24, 0.6, samples=2048)
        found.append(time.process_time() - started)
    return min(found)


def holds(slices, fixed, albedo):
    """(the albedo is within its limit, the slices are within theirs); slices that are not measured count as within."""
    return albedo <= ALBEDO, not slices > max(MEAN_SLICE, OF_FIXED * fixed)


def fixed_error(one, quality):
    """The mean error of slices that a bake of the same stack with fixed numbers reports."""
    return lamina.bake(one.stack, quality).report["fit_error"]


def words_of(number, base):
    """The first cells of a row."""
    return f"| {number} | {base.metallic:g} | {base.roughness:g} | {base.coat:g} | {', '.join(base.inputs) or '-'}"


def dust_rows(addon, number, base, quality, times):
    """(layers, row of the table, errors for `holds`) of one material under dust."""
    started = time.process_time()
    material, lut = principled_samples.baked(addon, f"material {number}", [DUST], base, quality)
    spent = time.process_time() - started
    base = with_channels(base)
    shown = [principled_samples.at(material, lut, DUST, base, tau) for tau in THICKNESSES]
    albedo = principled_samples.albedo_errors(shown, FURNACE_VIEWS, samples=512).max(axis=1)
    clean, bare = difference_from_the_bsdf(shown[0], base)
    words = words_of(number, base)
    for one, tau, slices, off in zip(shown[1:], THICKNESSES[1:], slices_of(shown[1:]), albedo[1:], strict=True):
        fixed = fixed_error(one, quality) if slices > MEAN_SLICE else float("nan")
        yield (f"dust {tau:g}", f"{words} | dust {tau:g} | {slices:.2%} | {fixed:.2%} | {off:.2%} |",
               (slices, fixed, off))
    ratio = seconds(shown[2].material) / seconds(bare) if times else float("nan")
    yield ("none", f"{words} | none | {clean:.1e} from the BSDF; bake {spent:.1f} CPU s; time {ratio:.2f} | | |",
           (float("nan"), float("nan"), clean))


def varnish_rows(addon, number, base, quality):
    """Like dust_rows, under varnish."""
    for name, varnish in (("varnish", VARNISH), *([("rough varnish", ROUGH_VARNISH)] if number in (3, 8, 17) else [])):
        material, lut = principled_samples.baked(addon, name, [varnish], base, quality)
        one = principled_samples.below(material, lut, [varnish], with_channels(base))
        off = principled_samples.albedo_errors([one], FURNACE_VIEWS, samples=512).max()
        slices, fixed = slices_of([one])[0], fixed_error(one, quality)
        yield (name, f"{words_of(number, base)} | {name} | {slices:.2%} | {fixed:.2%} | {off:.2%} |",
               (slices, fixed, off))


def with_channels(base):
    """The base with the color as one number per channel, as the node group has it."""
    return principled_samples.replace(base, color=tuple(float(c) for c in np.broadcast_to(base.color, 3)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quality", choices=("preview", "final"), default="final")
    parser.add_argument("--only", type=int, nargs=2, default=(0, len(MATERIALS)), metavar=("FIRST", "LAST"),
                        help="only these materials, without the last")
    parser.add_argument("--layers", choices=("all", "dust", "varnish"), default="all", help="only these layers")
    parser.add_argument("--no-times", action="store_true", help="do not measure times of renders")
    given = parser.parse_args()
    addon = addon_utils.enable("bl_ext.user_default.lamina", default_set=True)
    print("| | metallic | roughness | coat | inputs | layers | slices | with fixed numbers | albedo |")
    held: dict[str, list] = {}
    for number, base in list(enumerate(MATERIALS))[slice(*given.only)]:
        rows = []
        if given.layers != "varnish":
            rows.append(dust_rows(addon, number, base, given.quality, not given.no_times))
        if given.layers != "dust":
            rows.append(varnish_rows(addon, number, base, given.quality))
        for layers, row, errors in itertools.chain(*rows):
            print(row, flush=True)
            held.setdefault(layers, []).append(holds(*errors))
        for material in list(bpy.data.materials):
            bpy.data.materials.remove(material)
    for layers, found in held.items():
        albedo, slices = (sum(one) for one in zip(*found, strict=True))
        print(f"{layers}: albedo {albedo} of {len(found)}, slices {slices} of {len(found)}")


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # registered classes hang Blender's module at exit
