# SPDX-License-Identifier: GPL-3.0-or-later
"""Veined marble in 1D, in 3D and as Cycles' volume, on a slab and on a cup; dragons and a cup that glow."""

import dataclasses
import time

import numpy as np
import output
import picture
from PIL import Image

from . import bodies, differences, methods, portrait, sheet, turn, veins
from .portrait import Effort

OPTIONS = ("turntable",)  # arguments of run() beyond those of every scene
EXPOSURE = 1.1
# Effort of the methods, of the dragons, and of the cup.
QUALITIES = {
    "tiny": (methods.Effort(12, 4, 8, 0.1, 3, 6, 8), Effort(2, 64, 2), Effort(2, 64, 2)),
    "small": (methods.Effort(36, 6, 14, 0.1, 3, 10, 24), Effort(4, 300, 10), Effort(16, 300, 10)),
    "final": (methods.Effort(96, 16, 24, 0.05, 4, 64, 128), Effort(14, 1000, 48), Effort(160, 1000, 48)),
}


def run(out, quality, stack_path, say, turntable=0):
    """Render marble.png, marble_lit.png and marble.json into `out`. Returns (files, verdict, True if all is well).

    turntable: number of frames of marble_turntable.png, in which a sun goes once around the dragon. Raises ValueError
    for a stack: the stone has its own coefficients."""
    if stack_path is not None:
        raise ValueError(f"stack = {stack_path}: marble has no stack; leave the option out")
    of_bodies, *of_portraits = QUALITIES[quality]
    files = [out / "marble.png", out / "marble_lit.png", out / "marble.json"]
    pattern, rows, facts = veins.Veins(), [], {}
    for body in (bodies.slab(), bodies.cup()):
        made = methods.make(body, pattern, of_bodies, say)
        found = compared(made)
        rows.append(({methods.NAMES[name]: shots.mean(axis=0) for name, shots in made.pictures.items()}, made.region,
                     [_lines(found.get(name), differences.noise(shots, made.region))
                      for name, shots in made.pictures.items()]))
        facts[body.name] = {
            "pixels": int(made.region.sum()), "columns_solved": made.columns_solved, "cpu_seconds": made.seconds,
            "noise": {name: differences.noise(shots, made.region) for name, shots in made.pictures.items()},
            "differences": {name: dataclasses.asdict(one) for name, one in found.items()},
        }
        for name, one in found.items():
            say(f"{body.name}: {methods.NAMES[name]}: {_numbers(one)}")
    sheet.save(files[0], ("Veined marble by six methods", _describe(of_bodies)), rows, EXPOSURE)
    say(f"{files[0].name} is written")
    pictures, facts["portraits"] = _portraits(*of_portraits, say)
    shown = np.concatenate(pictures, axis=1)
    output.place(files[1], lambda partial: Image.fromarray(shown).save(partial, "PNG", optimize=True))
    output.save_json(files[2], {
        "quality": quality, "effort": dataclasses.asdict(of_bodies),
        "effort_portraits": [dataclasses.asdict(one) for one in of_portraits],
        "veins": dataclasses.asdict(pattern), "white": veins.WHITE, "vein": veins.VEIN, **facts,
    })
    if turntable:
        files.append(out / "marble_turntable.png")
        output.save_moving(files[-1], _turntable(of_portraits[0], turntable, say))
    found, well = facts["slab"]["differences"], verdict_holds(facts["slab"]["differences"])
    numbers = ", ".join(f"{methods.NAMES[name]} {_rms(differences.Difference(**one))[4:]}"
                        for name, one in found.items())
    text = f"slab, rms difference from Cycles' volume: {numbers}"
    return files, text if well else f"{text}; NOT AS IT SHOULD BE", well and all(map(np.any, pictures))


def compared(made):
    """differences.Difference of each method against the truth, by name."""
    truth = made.pictures["truth"]
    return {name: differences.difference(truth, shots, made.region)
            for name, shots in made.pictures.items() if name != "truth"}


def verdict_holds(found):
    """True if Lit agrees with the truth within 2 % rms, and if Relightable has at most half the error of the stock
    node, each within 3 standard errors. `found`: differences of the slab as plain data, by method."""
    lit, ours, stock = (found[name] for name in ("lit", "relightable", "stock"))
    limit = 0.02**2 + 3.0 * lit["square_error"]
    noise = 3.0 * np.hypot(ours["square_error"], 0.25 * stock["square_error"])
    return bool(lit["square"] <= limit and ours["square"] <= 0.25 * stock["square"] + noise)


def _portraits(of_dragons, of_cup, say):
    """(sRGB pictures of both dragons and of the cup, facts as plain data)."""
    dragon, cup = portrait.dragon(), portrait.cup()
    pictures, facts = [], {}
    for stone, made, effort in ((portrait.MARBLE, dragon, of_dragons), (portrait.GREEN, dragon, of_dragons),
                                (portrait.CANDLE, cup, of_cup)):
        start = time.process_time()
        pixels, known = portrait.picture(stone, made, effort)
        pictures.append(picture.tone(pixels, stone.exposure))
        facts[stone.name] = {**known, **dataclasses.asdict(stone), "cpu_seconds": time.process_time() - start}
        say(stone.name)
    return pictures, facts


def _turntable(effort, count, say):
    """The frames of a sun that goes once around the marble dragon, as PIL images."""
    images = []
    for pixels in turn.frames(portrait.MARBLE, portrait.dragon(), effort, count):
        images.append(Image.fromarray(picture.tone(pixels, turn.EXPOSURE)))
        say(f"marble: frame {len(images)} of {count}")
    return images


def _numbers(one):
    return f"mean {one.mean:+.1%} \u00b1 {one.mean_error:.1%}, {_rms(one)}"


def _rms(one):
    """The rms with its standard error, or its limit at two standard errors if noise alone explains the difference."""
    if one.square > 2.0 * one.square_error:
        return f"rms {one.rms:.1%} \u00b1 {one.square_error / (2.0 * one.rms):.1%}"
    return f"rms below {np.sqrt(max(one.square, 0.0) + 2.0 * one.square_error):.1%}"


def _lines(one, noise):
    if one is None:
        return [f"noise of a pixel {noise:.1%}", "Colours: difference / mean"]
    return [_rms(one), f"mean {one.mean:+.1%} \u00b1 {one.mean_error:.1%}",
            f"noise of a pixel {noise:.1%}" if noise else "no noise"]


def _describe(effort):
    return (f"Sun and sky. Truth: {effort.seeds * effort.truth} samples per pixel. rms: of pixels, relative to the "
            "mean, with the noise of both pictures subtracted. Below: differences from the truth.")
