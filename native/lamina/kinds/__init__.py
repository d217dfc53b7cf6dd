# SPDX-License-Identifier: GPL-3.0-or-later
"""What a stack and settled dust are described by: kinds, and for each its fields with name, range, default and words.

`lamina` checks its input by these descriptions. The add-on builds its properties and its panel from the same files,
also where the compiled modules are missing: this room imports the standard library alone, and nothing outside itself.
"""
