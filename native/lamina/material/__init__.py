# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a stack: media, phase functions, boundaries, bases, metals by name, the library of presets."""
