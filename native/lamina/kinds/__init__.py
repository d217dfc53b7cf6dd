# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of things in a stack, and their fields: name, range, unit, default and words for the panel. Also of dust.

`lamina` checks its input against these descriptions. The add-on builds its properties and panel from the same files,
also where the wheel is missing. So this room imports nothing but itself and the standard library.
"""
