# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of things in a stack, and of dust, with their fields: name, range, unit, default and texts of the panel.

`lamina` checks its input against these descriptions. The add-on builds its properties and panel from the same files,
also when the wheel is missing. This package therefore imports only itself and the standard library.
"""
