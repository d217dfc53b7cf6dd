# SPDX-License-Identifier: GPL-3.0-or-later
"""A file of schema 2 shows the numbers of its bakes as the Lamina that wrote the file did."""

from pathlib import Path

import bpy

LINES = {
    "Sheet": [
        ("Fit Error", "1.5 % mean, 1.5 % worst"),
        ("Worst At", "39° view, red"),
        ("Transmission", "32.6 % mean, 35.8 % worst"),
        ("Worst At", "36° view, red"),
        ("Albedo Error", "< 0.01 %"),
        ("Energy Error", "0.00 %"),
        ("Closures", "10, standard fit"),
        ("Baked", "Preview, 1.07 s"),
    ],
    "Dusty": [
        ("Fit Error", "0.6 % mean, 6.2 % worst"),
        ("Worst At", "86° view, red, thickness 0.3"),
        ("Albedo Error", "< 0.01 %"),
        ("Energy Error", "0.00 %"),
        ("Closures", "7, standard fit"),
        ("Baked", "Preview, 0.73 s"),
    ],
}  # fmt: skip
BELOW = [
    ("Shader Below", "Approximate. Error of the energy:"),
    ("If Matte", "0.1 %"),
    ("If Rough Metal", "0.1 %"),
    ("In One Channel", "0.1 %"),
    ("Without Reflectance", "3.3 %"),
]
BATCH = {
    "Sheet": "fit error 1.46 %, worst slice 1.5 %, transmission 32.59 %, worst slice 35.8 %, 10 closures, standard, "
             "preview, 1.00 s",
    "Dusty": "fit error 0.65 %, worst slice 6.2 %, 7 closures, standard, preview, 1.00 s",
}  # fmt: skip


def test_the_numbers_of_a_bake_are_kept(addon):
    file = Path(__file__).parents[1] / "files" / "schema_2.blend"
    bpy.ops.wm.open_mainfile(filepath=str(file))
    addon.properties.migration.migrate_all()
    for name, lines in LINES.items():
        result = bpy.data.materials[name].lamina.result
        assert addon.ui.numbers.result_lines(result) == lines
        assert addon.command_line.words.bake(result, 1.0) == BATCH[name]
    dusty = bpy.data.materials["Dusty"].lamina.result
    assert addon.ui.numbers.below_lines(dusty) == BELOW
    assert len(dusty.report["row_errors"]["tau"]) == 33 and dusty.report["tau_error"] is None
    assert addon.ui.numbers.below_lines(bpy.data.materials["Sheet"].lamina.result) == []
