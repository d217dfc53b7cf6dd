# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user sees of the package at a prompt."""

import lamina


def test_dir_lists_the_public_names_alone():
    assert set(dir(lamina)) == {*lamina.__all__, "__version__"}
    assert all(hasattr(lamina, name) for name in dir(lamina))


def test_dir_of_the_presets_too():
    assert set(dir(lamina.presets)) == set(lamina.presets.__all__)
