# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of results, which are written completely or not at all."""

import json
import os


def place(path, write):
    """Calls `write` with the name of a temporary file beside `path`, then renames this file to `path`."""
    partial = f"{path}.part"
    write(partial)
    os.replace(partial, path)


def save_json(path, facts):
    def write(partial):
        with open(partial, "w", encoding="utf-8") as file:
            file.write(json.dumps(facts, indent=2) + "\n")

    place(path, write)


def save_moving(path, images, seconds=4.0):
    """Write PIL images as an animated PNG that repeats. `seconds`: duration of one repetition."""
    place(path, lambda partial: images[0].save(partial, "PNG", save_all=True, append_images=images[1:],
                                               duration=max(40, round(1000.0 * seconds / len(images))), loop=0))
